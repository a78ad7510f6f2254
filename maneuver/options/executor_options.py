"""Options for the executor: local processes, or a Dask cluster."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Annotated

from cyclopts import Parameter

from flight.errors import FlightError
from runtime.cluster import cluster_executor
from runtime.executor import JobExecutor, default_workers, worker_pool

from .numbers import Count


@dataclass(frozen=True, slots=True)
class ExecutorOptions:
    """Executor that a command uses.

    Attributes:
        workers: number of processes on this machine; one per processor by default.
        cluster: address of a Dask scheduler, such as tcp://host:8786, or its scheduler file; flights then run
            on its workers.
        shared_folder: let the cluster's workers write the files, in folders shared with this machine; by
            default they send the files back.
    """

    workers: Count | None = None
    cluster: str | None = None
    shared_folder: Annotated[bool, Parameter(negative="")] = False

    def __post_init__(self) -> None:
        """Refuses options that contradict each other.

        Raises:
            FlightError: they do.
        """
        if self.cluster is None and self.shared_folder:
            raise FlightError("--shared-folder: expected --cluster, got none")
        if self.cluster is not None and self.workers is not None:
            raise FlightError("--workers: expected no --cluster, got one; a cluster has its own workers")


THIS_MACHINE = ExecutorOptions()
"""All processors of this machine."""

ExecutorArgument = Annotated[ExecutorOptions, Parameter(name="*")]
"""Options without a prefix."""


@contextmanager
def open_executor(options: ExecutorOptions) -> Iterator[JobExecutor]:
    """Opens an executor: processes of this machine, or a cluster.

    Raises:
        FlightError: the cluster does not answer.
    """
    if options.cluster is None:
        with worker_pool(options.workers or default_workers()) as pool:
            yield JobExecutor(pool)
    else:
        with cluster_executor(options.cluster) as executor:
            yield JobExecutor(executor, by_value=not options.shared_folder)
