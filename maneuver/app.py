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

# Where each verb is and, for the overview, what it does; a verb's module is imported only when it is called.
VERBS = {
    "demo": ("maneuver.demo:demo", "The whole way, small: fly, identify, plan, fly the plans, review."),
    "fly": ("maneuver.fly:fly", "Flies a sequence, a mission or a campaign; writes flight logs."),
    "identify": ("maneuver.identify:identify", "Flight logs in, library with its data sheet out."),
    "segment": (
        "maneuver.segment:segment",
        "Maneuvers found in the motion alone, beside the commanded ones.",
    ),
    "regenerate": ("maneuver.regenerate:regenerate", "Flies a campaign and identifies its library."),
    "plan": ("maneuver.plan.plan:app", "A mission in, a plan out; `plan check` checks one."),
    "validate": ("maneuver.validate:validate", "Flies missions many times, beside what was planned."),
    "faults": (
        "maneuver.faults:faults",
        "Flies faults in closed loop: safe, detected loss or undetected failure.",
    ),
    "import": ("maneuver.import_log:import_log", "A log of PX4 in, a flight log out."),
    "review": ("maneuver.review:review", "A flight log in; summary, page and pictures out."),
    "thesis": ("maneuver.thesis:thesis", "Every printed table of the thesis beside the computed one."),
    "verify": ("maneuver.verify:verify", "The physics and the margins, each figure beside its bar."),
    "replay": ("maneuver.replay:replay", "Logged flights flown again from their logs, compared to the byte."),
    "recover": ("maneuver.recover:recover", "A damaged log in, what is whole of it out."),
    "library": (
        "maneuver.library.show:app",
        "Shows, checks, tests, compares, interpolates and makes libraries.",
    ),
}


class _Stopped(KeyboardInterrupt):
    """A signal has come."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = signal.Signals(number)


def _one_line(error: CycloptsError) -> str:
    return f"maneuver: {' '.join(str(error).split())}"


def build(*, overview: bool = False) -> App:
    """Returns the application.

    Args:
        overview: whether a line for each verb stands in for the verb's own help.
    """
    app = App(
        name="maneuver",
        version=VERSION,
        help=(
            "Flies a simulated helicopter, identifies motion primitives with their uncertainties from the "
            "flight logs, plans minimum-time missions that survive those uncertainties, and proves each plan "
            "by flying it again."
        ),
        error_formatter=_one_line,
        error_console=Console(stderr=True, soft_wrap=True, markup=False, highlight=False),
        suppress_keyboard_interrupt=False,
    )
    for name, (place, words) in VERBS.items():
        app.command(place, name=name, help=words if overview else None)
    return app


def run(arguments: Sequence[str] | None = None) -> int:
    """Runs one command and returns its exit code.

    0 yes; 1 the honest no; 2 bad input or usage, one line on stderr.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    left = RESUME if _is_resumable(words) else WHOLE
    try:
        app = build(overview=not words or words[0] in {"--help", "-h"})
        code = app(words, result_action="return_value")
        sys.stdout.flush()
    except FlightError as error:
        return _print_error(str(error), BAD_INPUT)
    except BrokenProcessPool:
        return _print_error(f"a worker process died: killed, or out of memory; {left}", WORKER_DIED)
    except KeyboardInterrupt as stop:
        number = stop.number if isinstance(stop, _Stopped) else signal.SIGINT
        return _print_error(f"{STOPPING[number]}; {left}", 128 + number)
    except BrokenPipeError:
        # Whoever read the output has gone; keep the interpreter from complaining when it closes stdout.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _print_error(f"the system says no: {error}", BAD_INPUT)
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
        # Who started this in the background, or with nohup, has said that it shall not hear them.
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _stop)
    sys.exit(run())
