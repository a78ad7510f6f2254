"""Application: the verbs, and one line for every failure."""

import os
import signal
import sys
from collections.abc import Sequence
from concurrent.futures.process import BrokenProcessPool
from types import FrameType

from cyclopts import App, CycloptsError
from rich.console import Console

from flight.errors import FlightError
from runtime.version import VERSION

WHOLE = "all files written are complete"
RESUME = f"{WHOLE}; the same command resumes"

RESUMING = {"regenerate": "", "fly": "--campaign", "validate": "--out", "faults": "--out"}
"""Verbs that resume from the flights on disk, and the option that this needs."""

WORKER_DIED = 1
BAD_INPUT = 2
STOPPING = {signal.SIGINT: "interrupted", signal.SIGTERM: "asked to stop", signal.SIGHUP: "hung up on"}
"""Signals that end a command, in words; its exit code is 128 and the signal's number."""

BROKEN_PIPE = 128 + signal.SIGPIPE

HELP = {"--help", "-h"}

# Where each verb is and, for the overview, what it does; a verb's module is imported only when it is called.
VERBS = {
    "demo": ("maneuver.demo:demo", "Small example of all steps: fly, identify, plan, fly plans, review."),
    "fly": ("maneuver.fly:fly", "Flies a sequence, a mission or a campaign; writes flight logs."),
    "identify": ("maneuver.identify:identify", "Identifies a library from flight logs; writes a data sheet."),
    "segment": (
        "maneuver.segment:segment",
        "Finds maneuvers from motion alone and compares them with the commands.",
    ),
    "regenerate": ("maneuver.regenerate:regenerate", "Flies a campaign and identifies its library."),
    "plan": ("maneuver.plan.plan:app", "Plans a mission; `plan check` checks a plan."),
    "validate": (
        "maneuver.validate:validate",
        "Flies missions in closed loop and compares them with their plans.",
    ),
    "faults": (
        "maneuver.faults:faults",
        "Flies faults in closed loop; counts safe flights, detected losses, undetected failures.",
    ),
    "import": ("maneuver.import_log:import_log", "Imports a PX4 ULog, an MCAP file or a table."),
    "review": ("maneuver.review:review", "Reviews flight logs: summary, page and pictures."),
    "thesis": ("maneuver.thesis:thesis", "Compares every printed table of the thesis with computed figures."),
    "verify": ("maneuver.verify:verify", "Checks physics and margins of the simulator against their limits."),
    "replay": ("maneuver.replay:replay", "Flies logged flights again and compares the logs byte by byte."),
    "recover": ("maneuver.recover:recover", "Recovers the intact part of a damaged log."),
    "library": (
        "maneuver.library.show:app",
        "Shows, checks, tests, compares, interpolates and makes libraries.",
    ),
}


class _Stopped(KeyboardInterrupt):
    """Stop by a signal."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = signal.Signals(number)


def _one_line(error: CycloptsError) -> str:
    return f"maneuver: {' '.join(str(error).split())}"


def build(*, overview: bool = False) -> App:
    """Returns the application.

    Args:
        overview: list each verb with one line instead of its own help.
    """
    app = App(
        name="maneuver",
        version=VERSION,
        help=(
            "Flies a simulated helicopter, identifies motion primitives with uncertainties from the flight "
            "logs, plans minimum-time missions that are robust to these uncertainties, and validates the "
            "plans in closed-loop flights."
        ),
        error_formatter=_one_line,
        error_console=Console(stderr=True, soft_wrap=True, markup=False, highlight=False),
        suppress_keyboard_interrupt=False,
    )
    for name, (place, words) in VERBS.items():
        app.command(place, name=name, help=words if overview else None)
    return app


def _build_for(words: Sequence[str]) -> App:
    """Returns the application with the help texts that a command line needs."""
    verbs = [word for word in words if word not in HELP]
    app = build(overview=not verbs)
    if len(verbs) == 1 and verbs[0] in VERBS:
        # The help of a verb's own verbs is empty until they are imported.
        for name in app[verbs[0]]:
            app[verbs[0]][name]
    return app


def run(arguments: Sequence[str] | None = None) -> int:
    """Runs one command and returns its exit code.

    0 success; 1 negative result; 2 bad input or usage, one line on stderr.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    left = RESUME if _is_resumable(words) else WHOLE
    try:
        code = _build_for(words)(words, result_action="return_value")
        sys.stdout.flush()
    except FlightError as error:
        return _print_error(str(error), BAD_INPUT)
    except BrokenProcessPool:
        return _print_error(f"a worker process died: killed, or out of memory; {left}", WORKER_DIED)
    except KeyboardInterrupt as stop:
        number = stop.number if isinstance(stop, _Stopped) else signal.SIGINT
        return _print_error(f"{STOPPING[number]}; {left}", 128 + number)
    except BrokenPipeError:
        # The reader of the output is gone; without this the interpreter complains when it closes stdout.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _print_error(f"system error: {error}", BAD_INPUT)
    return code if isinstance(code, int) else 0


def _is_resumable(words: Sequence[str]) -> bool:
    """Returns True if the command resumes after a stop."""
    options = {"", *(word.partition("=")[0] for word in words)}
    return any(words[:1] == [verb] and option in options for verb, option in RESUMING.items())


def _print_error(line: str, code: int) -> int:
    print(f"maneuver: {line}", file=sys.stderr)
    return code


def _stop(number: int, _: FrameType | None) -> None:
    """Ends the command in order; a second signal ends it at once."""
    for each in STOPPING:
        signal.signal(each, signal.SIG_DFL)
    raise _Stopped(number)


def main() -> None:
    """Entry point of the `maneuver` command."""
    for number in STOPPING:
        # Started in the background or with nohup: the signal stays ignored.
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _stop)
    sys.exit(run())
