"""A traffic law that has been read and checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from drivora_service.oracles.laws.formula import Formula
from drivora_service.oracles.verdict import Severity

MAX_SUB_VIOLATIONS = 32
"""Greatest number of sub-violations of a law: each is an objective of a search."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LawParameter:
    """A number in a formula.

    Attributes:
        unit: As written in the file.
    """

    name: str
    value: float
    unit: str
    meaning: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Law:
    """A traffic law.

    Attributes:
        name: Name of the oracle.
        title: A few words.
        source: The law and its article.
        description: One sentence: what violates it.
        left_out: What of the article the formula leaves out.
        severity: Severity of its violations.
        parameters: Numbers that the formula names.
        text: The formula as written, in one line.
        formula: What must hold in every row.
        condition: In normal form, what must hold for the law to ask for anything: A of
            ``always (A -> B)``; ``None`` for a law of another form.
        violation: Its negation, in normal form.
        sub_violations: The ways to violate it, in normal form; their disjunction is ``violation``.
        file: Name of its file.
        sha256: Hash of that file; "" for a shipped law.
    """

    name: str
    title: str
    source: str
    description: str
    left_out: str
    severity: Severity
    parameters: tuple[LawParameter, ...]
    text: str
    formula: Formula
    condition: Formula | None
    violation: Formula
    sub_violations: tuple[Formula, ...]
    file: str
    sha256: str = ""

    @property
    def thresholds(self) -> Mapping[str, float]:
        """The values of its parameters by name."""
        return {parameter.name: parameter.value for parameter in self.parameters}


@dataclass(frozen=True, slots=True, kw_only=True)
class BrokenLawFile:
    """A law file that cannot be used.

    Attributes:
        file: Name of the file, under which it is listed.
        reason: All mistakes with their places.
    """

    file: str
    reason: str
