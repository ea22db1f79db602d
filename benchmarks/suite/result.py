"""The result of the suite, and its file.

The file is the JSON of :class:`SuiteResult`; the classes of this module are its schema, which
``python -m benchmarks schema`` prints as JSON Schema.
"""

from __future__ import annotations

import statistics
from enum import StrEnum
from pathlib import Path
from typing import Final, Literal

from pydantic import TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass

from drivora_service.errors import DrivoraError

VERSION: Final = 1
"""Of the file's schema; a change of a field's meaning raises it."""


class ResultError(DrivoraError):
    """A file is not a result of the suite."""


class Better(StrEnum):
    """Which direction of a quantity is an improvement."""

    LOWER = "lower"
    HIGHER = "higher"
    NEITHER = "neither"


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """One measured quantity.

    Attributes:
        case: What it was measured on, such as ``Town01, 11 actors``.
        name: What was measured, such as ``run / floor``.
        unit: Its unit; "" for ratios.
        better: Which direction is an improvement.
    """

    case: str
    name: str
    unit: str
    better: Better = Better.LOWER


@dataclass(frozen=True, slots=True, kw_only=True)
class Series:
    """The values of a quantity.

    Attributes:
        quantity: The quantity.
        values: One value a round, in the order of the rounds.
    """

    quantity: Quantity
    values: tuple[float, ...]

    @property
    def median(self) -> float:
        """Median of the rounds."""
        return statistics.median(self.values)

    @property
    def low(self) -> float:
        """Smallest value."""
        return min(self.values)

    @property
    def high(self) -> float:
        """Largest value."""
        return max(self.values)


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """The result of one measurement.

    Attributes:
        name: Name of the measurement.
        title: Heading.
        about: What is measured, and how.
        load: Load of the machine (mean of one minute) before the first round.
        seconds: Duration, with preparation.
        series: The measured values.
        remarks: Sentences about what was left out, and why.
    """

    name: str
    title: str
    about: str
    load: float
    seconds: float
    series: tuple[Series, ...]
    remarks: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class PackageVersion:
    """The version of an installed package."""

    package: str
    version: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """Where and on what the suite ran.

    Attributes:
        cpu: Model of the processor.
        cores: Cores that this process may use.
        memory_gb: Main memory, gigabytes.
        system: Operating system and kernel.
        python: Version of Python.
        load: Mean number of running processes over 1, 5 and 15 minutes, at the beginning.
        nice: Priority of the measuring process; 0 is the usual one, 19 the lowest.
        commit: Commit of the sources; "-dirty" is added if files differ from it, "" if unknown.
        packages: Versions of the packages that matter.
    """

    cpu: str
    cores: int
    memory_gb: float
    system: str
    python: str
    load: tuple[float, float, float]
    nice: int
    commit: str
    packages: tuple[PackageVersion, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SuiteResult:
    """The result of the suite.

    Attributes:
        schema: Version of the file's schema.
        begun: UTC time of the beginning, ISO 8601.
        short: Whether it is the short form, whose values say little.
        command: Arguments of ``python -m benchmarks``.
        machine: Where it ran.
        sections: One for each measurement, in the order of measuring.
    """

    schema: Literal[1] = VERSION
    begun: str
    short: bool
    command: tuple[str, ...]
    machine: Machine
    sections: tuple[Section, ...]


ADAPTER: TypeAdapter[SuiteResult] = TypeAdapter(SuiteResult)


def read_result(path: Path) -> SuiteResult:
    """Reads a result.

    Raises:
        ResultError: The file cannot be read, or is not a result of the suite.
    """
    try:
        return ADAPTER.validate_json(path.read_bytes())
    except OSError as error:
        raise ResultError(f"{path}: {error.strerror}") from error
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"]) or "the file"
        raise ResultError(
            f"{path} is not a result of `python -m benchmarks` (schema {VERSION}): "
            f"{place}: {first['msg']}"
        ) from error


def write_result(result: SuiteResult, path: Path) -> None:
    """Writes a result."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(ADAPTER.dump_json(result, indent=1) + b"\n")
