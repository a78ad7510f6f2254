"""Executor on a Dask cluster, by the address of its scheduler."""

import logging
from collections.abc import Iterator
from concurrent.futures import CancelledError, Executor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from flight.errors import FlightError

CONNECTION_TIMEOUT = 15
"""Seconds within which a scheduler must answer."""


class ClusterLostError(FlightError):
    """Loss of the cluster, or of several workers on one job."""

    def __init__(self, address: str, why: str) -> None:
        super().__init__(
            f"--cluster {address}: connection or workers lost: {why}; existing files are complete, "
            "repeat the command to resume"
        )


class NoClusterError(FlightError):
    """Missing cluster at an address."""

    def __init__(self, address: str, why: str) -> None:
        super().__init__(f"--cluster {address}: expected a Dask scheduler, got {why}")


@contextmanager
def cluster_executor(address: str) -> Iterator[Executor]:
    """Yields an executor that runs jobs on a cluster's workers.

    Args:
        address: such as `tcp://host:8786`, or a scheduler file.

    Raises:
        FlightError: the extra is not installed.
        NoClusterError: no scheduler answers.
        ClusterLostError: the connection or the workers were lost.
    """
    try:
        from distributed import Client, KilledWorker
        from distributed.comm.core import CommClosedError
    except ImportError:
        raise FlightError(
            "--cluster needs the package `distributed`: pip install 'maneuver-automaton[cluster]'"
        ) from None
    # Its messages about connections opened and closed are of no use to users.
    for name in [name for name in logging.root.manager.loggerDict if name.startswith("distributed")]:
        logging.getLogger(name).setLevel(logging.CRITICAL)
    by_file = {"scheduler_file": address} if Path(address).is_file() else {"address": address}
    client: Any
    try:
        # Dask is untyped.
        client = Client(**by_file, timeout=CONNECTION_TIMEOUT, set_as_default=False)  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as error:
        raise NoClusterError(address, " ".join(str(error).split()) or type(error).__name__) from None
    try:
        yield client.get_executor()
    except (CancelledError, CommClosedError, KilledWorker) as error:
        raise ClusterLostError(address, type(error).__name__) from None
    finally:
        client.close(timeout=CONNECTION_TIMEOUT)
