"""Short ways to make laws and to judge by them, for tests."""

from __future__ import annotations

from functools import cache

from drivora_service.oracles.laws.law import Law
from drivora_service.oracles.laws.law_judging import LawOracle
from drivora_service.oracles.laws.law_reading import read_laws
from drivora_service.oracles.laws.library import LawLibrary
from drivora_service.oracles.laws.sources import LawSource


def source_of(
    condition: str, *, name: str = "own_law", severity: str = "minor", file: str = "own.yaml"
) -> LawSource:
    """A file with one law without parameters."""
    text = (
        f"laws:\n  - name: {name}\n    title: Own law\n    source: nobody\n"
        f"    description: It is violated.\n    severity: {severity}\n"
        f"    formula: always ({condition})\n"
    )
    return LawSource(file=file, data=text.encode())


def law_of(condition: str, *, severity: str = "minor") -> Law:
    (law,) = read_laws(source_of(condition, severity=severity))
    return law


@cache
def library() -> LawLibrary:
    return LawLibrary()


def shipped(name: str) -> LawOracle:
    return LawOracle(law=library().law(name))
