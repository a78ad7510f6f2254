"""A fault matrix: what goes wrong, whether it must be survived, and what is expected then."""

from dataclasses import dataclass
from pathlib import Path

from experiments.mission.safe_envelope import SafeEnvelope
from flight.mission.fault import Fault, parse_fault
from flight.schema import FileModel, read_toml, refusing
from scenarios.find import FAULTS, find_file


@dataclass(frozen=True, slots=True)
class FaultCase:
    """One row of a fault matrix.

    Attributes:
        fault: what goes wrong.
        contract: whether the mission must go on and reach its goal; outside the contract the vehicle may be
            lost, but must say so.
        expected: what is expected, for people.
    """

    fault: Fault
    contract: bool
    expected: str


@dataclass(frozen=True, slots=True)
class FaultMatrix:
    """Faults that are flown one at a time, and the envelope in which a flight counts as safe."""

    name: str
    envelope: SafeEnvelope
    cases: tuple[FaultCase, ...]

    def __post_init__(self) -> None:
        """Refuses a matrix without a fault, or with one twice."""
        words = [case.fault.words for case in self.cases]
        if not words:
            raise ValueError("fault: expected one or more, got none")
        twice = next((one for one in words if words.count(one) > 1), None)
        if twice is not None:
            raise ValueError(f"fault: {twice!r} is there twice")


class _Case(FileModel):
    words: str
    contract: bool
    expected: str


class _MatrixFile(FileModel):
    name: str
    envelope: SafeEnvelope
    fault: tuple[_Case, ...]


def read_fault_matrix(path: Path) -> FaultMatrix:
    """Reads `faults/NAME.toml`.

    Raises:
        BadFileError: the file is missing, is no TOML, or names a fault that there is not.
    """
    content = read_toml(path, _MatrixFile)
    with refusing(path):
        cases = tuple(FaultCase(parse_fault(row.words), row.contract, row.expected) for row in content.fault)
        return FaultMatrix(content.name, content.envelope, cases)


def find_fault_matrix(name: str) -> FaultMatrix:
    """Reads a fault matrix by path or shipped name.

    Raises:
        FlightError: there is none, or it is broken.
    """
    return read_fault_matrix(find_file("fault matrix", name, FAULTS, ".toml"))
