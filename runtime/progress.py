"""Progress bar on stderr, on terminals only."""

from collections.abc import Iterable, Iterator
from typing import TypeVar

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    Task,
    TextColumn,
    TimeRemainingColumn,
)
from rich.text import Text

Item = TypeVar("Item")


class _Rate(ProgressColumn):
    """Items per minute."""

    def render(self, task: Task) -> Text:
        """Returns the rate; a dash before the second item."""
        return Text("-/min" if task.speed is None else f"{60 * task.speed:.0f}/min", "progress.data.speed")


def show_progress(items: Iterable[Item], *, total: int, what: str, done: int = 0) -> Iterator[Item]:
    """Yields the items and shows count, rate and remaining time.

    Args:
        items: items to pass on.
        total: number of items, with those done before.
        what: label of the bar.
        done: number of items done before.
    """
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        _Rate(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task(what, total=total, completed=done)
        for item in items:
            yield item
            progress.advance(task)
