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
        workers: processes of this machine; one for each processor by default.
        cluster: fly on the workers of a Dask scheduler instead: its address, such as tcp://host:8786, or its
            scheduler file.
        shared_folder: the cluster's workers see the same folders and write into them, instead of sending
            files back.
    """

    workers: Count | None = None
    cluster: str | None = None
    shared_folder: Annotated[bool, Parameter(negative="")] = False

    def __post_init__(self) -> None:
        """Refuses options that contradict each other.

        Raises:
            FlightError: says which.
        """
        if self.cluster is None and self.shared_folder:
            raise FlightError("--shared-folder is for a cluster: give --cluster with it")
        if self.cluster is not None and self.workers is not None:
            raise FlightError("--workers are processes of this machine: a cluster has its own")


THIS_MACHINE = ExecutorOptions()
"""This machine, all of it."""

ExecutorArgument = Annotated[ExecutorOptions, Parameter(name="*")]
"""The options as a verb's own."""


@contextmanager
def open_executor(options: ExecutorOptions) -> Iterator[JobExecutor]:
    """Lends processes of this machine or, by its address, a cluster.

    Raises:
        FlightError: the cluster does not answer.
    """
    if options.cluster is None:
        with worker_pool(options.workers or default_workers()) as pool:
            yield JobExecutor(pool)
    else:
        with cluster_executor(options.cluster) as executor:
            yield JobExecutor(executor, by_value=not options.shared_folder)
