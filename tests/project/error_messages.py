"""Messages of errors that carry their own text, to be read together."""

from pathlib import Path

from mcap.records import Channel

from experiments.mission.feedback import MeasuredLatencyError
from experiments.mission.random_missions import NoMissionError
from experiments.mission.sensor_tolerance import ToleranceTooFineError
from flight import errors
from flight.mission.campaign import NoRuleForWindError
from flight.mission.fault import BadFaultError
from flight.plan.plan import Plan
from flight.se2 import Twist
from flightlog.imports.mcap_messages import UnknownEncodingError
from flightlog.log import MissingTopicError
from flightlog.series import MissingFieldError
from flightlog.topics import ESTIMATE, TRUTH
from identification.coverage_trial import NoClaimError
from identification.statistics.variance_shares import TooFewRepetitionsError
from maneuver.options.population import AirframeNotFlownError
from planner.closed_loop.automaton_vehicle import TrueGammaError
from planner.closed_loop.joint_law_vehicle import NoLawError
from planner.closed_loop.latency import LatencyRecordError
from planner.closed_loop.receding_horizon import NoToleranceError
from planner.independent_errors.independent_errors import TooManyScenariosError
from planner.policies.price_of_robustness import AlphaError
from planner.proof.certify_plan import NotProvableError
from planner.recourse.problem import ZeroDurationLoopError, ZeroToleranceError
from planner.recourse.solve import NotSolvedError
from planner.recourse.statement import GoalHeadingError
from planner.walks.kinematics import GammaError, NegativeDurationError
from review.film.canvas import NoCanvasError
from review.pictures.plan_picture import NothingToDrawError
from runtime.cluster import ClusterLostError, NoClusterError
from runtime.compiler import NoMachineCodeError
from runtime.job import CodeMismatchError
from runtime.job_store import BusyError, NotSharedError
from scenarios.find import NoSuchFileError, find_library
from sim.loop.backend import BitMismatchError
from sim.loop.specification import NoAirframeError, NoSensorsError, WindOrderError
from sim.navigation.sensor_errors import UnknownSensorsError
from sim.replay import VehicleMismatchError
from sim.vehicle.equilibrium import NoEquilibriumError
from sim.wind.flyable import NeededAirspeed, UnflyableWindError
from sim.wind.wind_class import UnknownWindError

LIBRARY = find_library("thesis-gtmax")
NO_PLAN = Plan(
    status="infeasible",
    library=LIBRARY.name,
    library_hash="",
    mission="m",
    policy="nominal",
    gamma=0.0,
    tolerance=1.0,
)

NEEDED = NeededAirspeed(mean_wind=18.0, gusts=10.0, trim_speed=3.0)

MESSAGES: tuple[tuple[errors.FlightError, str], ...] = (
    (
        errors.UnknownTrimError(9, [2, 1]),
        "no trim 9; the library has [1, 2]",
    ),
    (
        errors.NoManeuverError(1, 3, [2]),
        "no maneuver from trim 1 to trim 3; from trim 1 the library reaches [2]",
    ),
    (
        errors.BadFileError(Path("a.json"), "expected x, got y"),
        "a.json: expected x, got y",
    ),
    (
        errors.AlreadyExistsError(Path("a.json")),
        "a.json exists; give --force to overwrite it, or another name",
    ),
    (
        errors.CannotWriteError(Path("a.json"), "No space left on device"),
        "a.json: cannot be written: No space left on device",
    ),
    (
        errors.FlightLostError(12.5, "the motion diverged"),
        "flight lost at 12.50 s: the motion diverged",
    ),
    (
        errors.NoManeuverEndError("mine"),
        "library 'mine': expected conditions.maneuver_end (a band for each trim, dwell, timeout) "
        "for a flight, got none",
    ),
    (
        NoMissionError(LIBRARY, 0.5),
        "library thesis-gtmax: expected a worst-case plan at gamma 0.5 for one of 50 random "
        "missions, got none",
    ),
    (
        NoRuleForWindError("gtmax", "severe", {"calm": None, "gtmax": None}),
        "campaign gtmax has no maneuver_end for wind 'severe'; it has ['calm', 'gtmax']",
    ),
    (
        BadFaultError("gps dropout", "expected x, got y"),
        "fault 'gps dropout': expected x, got y",
    ),
    (
        UnknownEncodingError(Channel(1, "/odom", "ros1", {}, 0), None),
        "/odom: expected messages in CDR described by ros2msg or ros2idl, of ROS 1, in protobuf or in JSON, "
        "got ros1 described by nothing",
    ),
    (
        MissingTopicError(TRUTH, {"/estimate": None}),
        "the log has no /truth; it has ['/estimate']",
    ),
    (
        MissingFieldError(ESTIMATE, "climb"),
        "the log's /estimate has no climb; it has ['north', 'east', 'down', 'forward', 'side', "
        "'descent', 'roll', 'pitch', 'heading', 'roll_rate', 'pitch_rate', 'body_yaw_rate', "
        "'yaw_rate']",
    ),
    (
        NoLawError("mine", "trim 3"),
        "library mine: expected a joint law for every primitive (maneuver-library/2), trim 3 has none; "
        "identify it anew from at least two flights",
    ),
    (
        NoClaimError("mine"),
        "library mine: expected primitives with statistics to test, got none",
    ),
    (
        TrueGammaError(1.5),
        "the true gamma must be between -1 and 1, got 1.5",
    ),
    (
        LatencyRecordError(12),
        "expected a recorded latency for every replan, got only 12",
    ),
    (
        NoToleranceError("m"),
        "mission m: expected a goal tolerance > 0 m for a flight, got 0 m",
    ),
    (
        TooManyScenariosError(20),
        "expected at most 11 trims and maneuvers to enumerate all signs, got 20",
    ),
    (
        MeasuredLatencyError(),
        "expected a latency in s for the policy with feedback, got measured",
    ),
    (
        GoalHeadingError("m"),
        "mission m: expected a goal without a heading for feedback, got one",
    ),
    (
        ZeroToleranceError(),
        "expected a goal tolerance > 0 m for feedback, got 0 m",
    ),
    (
        ZeroDurationLoopError([2, 1]),
        "expected every loop of maneuvers to take time, got one of 0 s through trims [1, 2]",
    ),
    (
        NotSolvedError(0.2),
        "expected bounds of the least time at most 0.05 s apart after 200 sweeps, got 0.2 s",
    ),
    (
        AlphaError(0.5),
        "alpha must be >= 1, got 0.5",
    ),
    (
        NotProvableError("committed"),
        "expected a policy that can be certified, one of nominal, worst-case; got committed",
    ),
    (
        NegativeDurationError(3, -0.5, 1.0),
        "maneuver 3: duration must be >= 0 s, got -0.5 s at gamma 1.0",
    ),
    (
        GammaError(1.5),
        "gamma must be between 0 and 1, got 1.5",
    ),
    (
        NoCanvasError(["EGL: none", "GLFW: no display"]),
        "cannot render: expected off-screen OpenGL (EGL or OSMesa) or a display (GLFW); tried "
        "EGL: none; GLFW: no display",
    ),
    (
        NothingToDrawError(NO_PLAN),
        "cannot draw the plan for m: expected a solution, got status infeasible",
    ),
    (
        ClusterLostError("tcp://head:8786", "CommClosedError"),
        "--cluster tcp://head:8786: connection or workers lost: CommClosedError; existing files "
        "are complete, repeat the command to resume",
    ),
    (
        NoClusterError("tcp://head:8786", "a refused connection"),
        "--cluster tcp://head:8786: expected a Dask scheduler, got a refused connection",
    ),
    (
        NoMachineCodeError("got none"),
        "expected a working C compiler, cc, gcc, clang or that of the extra `compiler` (pip "
        "install '.[compiler]'): got none",
    ),
    (
        CodeMismatchError("0.2.0+aa", "0.2.0+bb"),
        "expected code 0.2.0+aa on every worker, got 0.2.0+bb; install the same version and "
        "packages there, and do not change them during the run",
    ),
    (
        BusyError(Path("flights")),
        "flights is locked by another program; wait for it, or give another folder",
    ),
    (
        NotSharedError(Path("flights/a.mcap")),
        "flights/a.mcap: written by a worker but not visible here; expected a folder shared by "
        "all machines; without --shared-folder workers send files back",
    ),
    (
        NoSuchFileError("mission", "far", ["gtmax-1", "gtmax-2"]),
        "no mission 'far': expected an existing file or one of ['gtmax-1', 'gtmax-2']",
    ),
    (
        BitMismatchError("plant"),
        "expected machine code of 'plant' with the interpreter's bits, got other bits",
    ),
    (
        NoSensorsError("gps dropout 10 2"),
        "fault 'gps dropout 10 2': expected sensor models, got ideal navigation",
    ),
    (
        WindOrderError([5.0, 7.0]),
        "expected wind changes in order and at least 5 s apart, got 5.0, 7.0 s",
    ),
    (
        VehicleMismatchError("vehicle", "aa", "bb"),
        "expected the vehicle of the log, aa, got bb: it cannot be repeated here",
    ),
    (
        NoEquilibriumError(Twist(90.0, 0.0, 0.0), "residual 1.0, expected at most 1e-9"),
        "no equilibrium at forward 90 m/s, side 0 m/s, yaw rate 0 rad/s: residual 1.0, expected at most 1e-9",
    ),
    (UnknownSensorsError("laser"), "no sensor class 'laser'; there are ['gps', 'rtk']"),
    (NoAirframeError(), "expected the seed of the airframe with vehicles 'one', got none"),
    (
        TooFewRepetitionsError("maneuver 3"),
        "maneuver 3: expected two flights and one with two performances, got fewer",
    ),
    (
        ToleranceTooFineError("m", "tolerance", "gps", needed=9.0, got=1.0, unit="m"),
        "mission m: expected a tolerance of at least 9 m (4 standard deviations of gps), got 1 m",
    ),
    (
        AirframeNotFlownError("fleet"),
        "--airframe: expected --vehicles one, got vehicles 'fleet'",
    ),
    (
        UnknownWindError("storm"),
        "no wind class 'storm'; there are ['calm', 'gtmax', 'light', 'moderate', 'severe'], "
        "or the wind at 20 ft in m/s, such as '4.5'",
    ),
    (
        UnflyableWindError("severe", height=30.0, needed=NEEDED, held=20.0),
        "wind severe cannot be flown: expected at most 20.0 m/s of airspeed, the most that the "
        "vehicle holds from every side, got 31.0 m/s (mean wind 18.0 at 30 m, gusts 10.0, trim speed 3.0)",
    ),
)
