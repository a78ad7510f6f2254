"""The command line: which verbs there are, and how every failure ends in one line."""

import os
import signal
import sys
from collections.abc import Sequence
from concurrent.futures.process import BrokenProcessPool

from cyclopts import App, CycloptsError
from rich.console import Console

from flight.errors import FlightError

VERSION = "0.1.0"

WORKER_DIED = 1
BAD_INPUT = 2
INTERRUPTED = 128 + signal.SIGINT
BROKEN_PIPE = 128 + signal.SIGPIPE


def _one_line(error: CycloptsError) -> str:
    return f"maneuver: {' '.join(str(error).split())}"


def build() -> App:
    """Returns the application; a verb's module is imported only when the verb is called."""
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
    )
    app.command("maneuver.demo:demo")
    app.command("maneuver.fly:fly")
    app.command("maneuver.identify:identify")
    app.command("maneuver.regenerate:regenerate")
    app.command("maneuver.plan:app", name="plan")
    app.command("maneuver.validate:validate")
    app.command("maneuver.review:review")
    app.command("maneuver.thesis:thesis")
    app.command("maneuver.library:app", name="library")
    app.command("maneuver.verify:verify")
    return app


def run(arguments: Sequence[str] | None = None) -> int:
    """Runs one command and returns its exit code.

    0 yes; 1 the honest no; 2 bad input or usage, one line on stderr.
    """
    try:
        code = build()(arguments, result_action="return_value")
        sys.stdout.flush()
    except FlightError as error:
        print(f"maneuver: {error}", file=sys.stderr)
        return BAD_INPUT
    except BrokenProcessPool:
        print("maneuver: a worker process died: killed, or out of memory", file=sys.stderr)
        return WORKER_DIED
    except KeyboardInterrupt:
        print("maneuver: interrupted; nothing half-written was left", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        # Whoever read the output has gone; keep the interpreter from complaining when it closes stdout.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    return code if isinstance(code, int) else 0


def main() -> None:
    """Entry point of the `maneuver` command."""
    sys.exit(run())
