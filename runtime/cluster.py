"""A cluster by the address of its Dask scheduler, as an executor; Dask is an extra."""

import logging
from collections.abc import Iterator
from concurrent.futures import CancelledError, Executor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from flight.errors import FlightError

CONNECTION_TIMEOUT = 15
"""Seconds in which a scheduler must answer."""


class ClusterLostError(FlightError):
    """A cluster went away while it was working, or lost one worker after another over the same work."""

    def __init__(self, address: str, why: str) -> None:
        super().__init__(
            f"--cluster {address}: the work was lost there: {why}; files that are there are whole, and the "
            "same command goes on from there"
        )


class NoClusterError(FlightError):
    """There is no cluster at an address."""

    def __init__(self, address: str, why: str) -> None:
        super().__init__(f"--cluster {address}: expected a Dask scheduler, got {why}")


@contextmanager
def cluster_executor(address: str) -> Iterator[Executor]:
    """Lends the workers of a cluster.

    Args:
        address: such as `tcp://host:8786`, or a scheduler file.

    Raises:
        FlightError: the extra is not installed.
        NoClusterError: nobody answers.
        ClusterLostError: the cluster went away.
    """
    try:
        from distributed import Client, KilledWorker
        from distributed.comm.core import CommClosedError
    except ImportError:
        raise FlightError(
            "--cluster needs the package `distributed`: pip install 'maneuver-automaton[cluster]'"
        ) from None
    # What it has to say of connections that come and go is no word for users.
    for name in [name for name in logging.root.manager.loggerDict if name.startswith("distributed")]:
        logging.getLogger(name).setLevel(logging.CRITICAL)
    by_file = {"scheduler_file": address} if Path(address).is_file() else {"address": address}
    client: Any
    try:
        # Dask has no types.
        client = Client(**by_file, timeout=CONNECTION_TIMEOUT, set_as_default=False)  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as error:
        raise NoClusterError(address, " ".join(str(error).split()) or type(error).__name__) from None
    try:
        yield client.get_executor()
    except (CancelledError, CommClosedError, KilledWorker) as error:
        raise ClusterLostError(address, type(error).__name__) from None
    finally:
        client.close(timeout=CONNECTION_TIMEOUT)
