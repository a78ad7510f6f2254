"""Proof of a lower bound: trees of boxes of coasting times.

A box is cut in two at one coasting time, again and again; each part that is not cut is refuted by
multipliers (`docs/planner.md` says how). A tree is written as a line of text, every node before its parts,
the earlier part first:

    2<3.25          a cut: the coasting time at place 2 (from 0), at 3.25 s
    1:0.3,-0.1;...  a refutation: kappa, the vector north and east in s/m, a number for each trim
    -               a box that the seconds allowed, or the heading wanted, leave empty
"""

from dataclasses import dataclass

from pydantic import PositiveInt

from flight.file_value import FileValue

LARGEST_NUMBER = 1e60
"""Of a multiplier: its square is still a number."""

_LONGEST_PLACE = 4
"""Digits of a place in a walk."""


@dataclass(frozen=True, slots=True)
class BoxSplit:
    """Split of a box at a coasting time, first part below it.

    Attributes:
        place: of the trim in the walk, from 0.
        time: seconds.
    """

    place: int
    time: float


@dataclass(frozen=True, slots=True)
class BoxLeaf:
    """Refutes a box, or marks it as empty.

    Attributes:
        kappa: 1 for a bound of the cost, 0 where the goal is out of reach; None where the box is empty.
        vector: north and east, seconds a metre.
        shares: one for each trim.
    """

    kappa: int | None = None
    vector: tuple[float, float] = (0.0, 0.0)
    shares: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class InfeasibilityCertificate(FileValue):
    """Proof that one walk is not faster.

    Attributes:
        sequence: trim ids.
        gamma: the uncertainty level at which it is not.
        tree: its boxes, as text.
    """

    sequence: tuple[int, ...]
    gamma: float
    tree: str


@dataclass(frozen=True, slots=True)
class Certificate(FileValue):
    """Proof of a plan's lower bound, or that there is no plan.

    Attributes:
        max_trims: longest walk considered.
        refutations: one for each walk.
    """

    max_trims: PositiveInt
    refutations: tuple[InfeasibilityCertificate, ...]


def write_tree(nodes: list[BoxSplit | BoxLeaf]) -> str:
    """Returns a tree as text, each node before its parts."""
    return " ".join(_token(node) for node in nodes)


def read_tree(text: str) -> list[BoxSplit | BoxLeaf]:
    """Reads a tree's nodes in order.

    Raises:
        ValueError: the text is not a tree.
    """
    nodes: list[BoxSplit | BoxLeaf] = []
    for token in text.split():
        try:
            nodes.append(_node(token))
        except ValueError:
            raise ValueError(
                f"expected a node such as 2<3.25, 1:0.3,-0.1;0,0 or -, got {token!r:.60}"
            ) from None
    return nodes


def _token(node: BoxSplit | BoxLeaf) -> str:
    if isinstance(node, BoxSplit):
        return f"{node.place}<{node.time!r}"
    if node.kappa is None:
        return "-"
    shares = ",".join(map(_shortest_decimal, node.shares))
    return f"{node.kappa}:{_shortest_decimal(node.vector[0])},{_shortest_decimal(node.vector[1])};{shares}"


def _shortest_decimal(value: float) -> str:
    text = repr(value)
    return text[:-2] if text.endswith(".0") else text


def _node(token: str) -> BoxSplit | BoxLeaf:
    if token == "-":
        return BoxLeaf()
    if "<" in token:
        place, time = token.split("<")
        if len(place) > _LONGEST_PLACE:
            raise ValueError(place)
        return BoxSplit(int(place), _number(time))
    kappa, rest = token.split(":")
    vector, shares = rest.split(";")
    north, east = vector.split(",")
    if kappa not in {"0", "1"}:
        raise ValueError(kappa)
    return BoxLeaf(
        int(kappa), (_number(north), _number(east)), tuple(_number(one) for one in shares.split(","))
    )


def _number(text: str) -> float:
    value = float(text)
    if not abs(value) <= LARGEST_NUMBER:
        raise ValueError(text)
    return value
