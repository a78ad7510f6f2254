"""Fault matrix: faults, contract and expected behaviour."""

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
        fault: the injected fault.
        contract: True if the mission must reach its goal; outside the contract the vehicle may be lost, but
            must raise an alarm.
        expected: expected behaviour, as a text.
    """

    fault: Fault
    contract: bool
    expected: str


@dataclass(frozen=True, slots=True)
class FaultMatrix:
    """Faults to fly one at a time, and the safe envelope."""

    name: str
    envelope: SafeEnvelope
    cases: tuple[FaultCase, ...]

    def __post_init__(self) -> None:
        """Checks that there are faults, each once."""
        words = [case.fault.words for case in self.cases]
        if not words:
            raise ValueError("fault: expected one or more, got none")
        twice = next((one for one in words if words.count(one) > 1), None)
        if twice is not None:
            raise ValueError(f"fault: expected different faults, got {twice!r} twice")


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
        BadFileError: the file is missing, is not TOML, or names an unknown fault.
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
