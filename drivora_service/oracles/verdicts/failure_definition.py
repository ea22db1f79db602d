"""What a failure is: the one definition that gates, comparisons, campaigns and lists obey.

A *violation* is a verdict of the outcome ``violated``. It is a *failure* if a definition counts it:
its oracle is one that the definition looks at, an ego is accountable for it to the degree that the
definition asks, it is not known, and it does not just follow from another violation that the
definition looks at. Nothing else in the project decides what counts.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import lru_cache
from typing import Any

from pydantic_core import from_json

from drivora_service.oracles.verdict import Outcome, Severity, Verdict
from drivora_service.oracles.verdicts.accountability import (
    ACCOUNTABLE,
    AT_FAULT,
    Accountability,
    accountability,
    strongest,
)
from drivora_service.oracles.verdicts.failure_facts import followed_oracle
from drivora_service.shapes import Shape, adapter


class Counted(StrEnum):
    """The violations that are failures, by the accountability of an ego."""

    ACCOUNTABLE = "accountable"
    """An ego is accountable: avoidable, not measurable whether, or fault is not attributed."""
    PREVENTABLE = "preventable"
    """As `accountable`, and also those at the fault of others that a careful driver avoids."""
    AT_FAULT = "at_fault"
    """As `accountable`, and also those that were not avoidable."""
    POSSIBLY_AT_FAULT = "possibly_at_fault"
    """As `at_fault`, and also those of undetermined fault: all but the faults of others."""
    ANY = "any"
    """Also the faults of others."""


_MOST_IN_WORDS = 3
"""Definitions that are written out where runs have several."""

_NOT_OF_OTHERS = ACCOUNTABLE | AT_FAULT | {Accountability.UNDETERMINED}

COUNTED: Mapping[Counted, frozenset[Accountability]] = {
    Counted.ACCOUNTABLE: ACCOUNTABLE,
    Counted.PREVENTABLE: ACCOUNTABLE | {Accountability.PREVENTABLE},
    Counted.AT_FAULT: ACCOUNTABLE | AT_FAULT,
    Counted.POSSIBLY_AT_FAULT: _NOT_OF_OTHERS,
    Counted.ANY: frozenset(Accountability),
}
"""The degrees of accountability that each counts."""

_DEGREES_IN_WORDS = {
    Counted.ACCOUNTABLE: "that an ego is accountable for",
    Counted.PREVENTABLE: "that an ego is accountable for, or that a careful driver avoids although "
    "another is at fault",
    Counted.AT_FAULT: "that an ego is accountable for, or at fault without a way out",
    Counted.POSSIBLY_AT_FAULT: "that are not known to be another's fault",
    Counted.ANY: "of any fault",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownFailure(Shape):
    """A failure that is known and does not count; "" stands for any.

    Attributes:
        agents: ADSs of which it is known; empty: every one.
        reason: Why it does not count.
    """

    oracle: str = ""
    ego: str = ""
    counterpart: str = ""
    agents: tuple[str, ...] = ()
    reason: str = ""

    def is_of(self, agents: frozenset[str]) -> bool:
        """Returns whether it is known of a run that these ADSs drive."""
        return not self.agents or not agents.isdisjoint(self.agents)

    def covers(self, oracle: str, ego: str, counterpart: str) -> bool:
        """Returns whether a failure is this one."""
        return (
            self.oracle in ("", oracle)
            and self.ego in ("", ego)
            and self.counterpart in ("", counterpart)
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class FailureDefinition(Shape):
    """What counts as a failure of a run.

    Attributes:
        counts: The violations that count, by the accountability of an ego.
        oracles: The only oracles that count, observations among them; null: all but observations.
        known: Failures that are known and do not count.
    """

    counts: Counted = Counted.ACCOUNTABLE
    oracles: tuple[str, ...] | None = None
    known: tuple[KnownFailure, ...] = field(default=())

    def looks_at(self, verdict: Verdict) -> bool:
        """Returns whether a verdict is a violation of an oracle that may count at all.

        One that only follows from a violation of another such oracle is none: the other one says
        whether that is a failure of the ego.
        """
        if verdict.outcome is not Outcome.VIOLATED or not self._names(verdict):
            return False
        cause = followed_oracle(verdict)
        return not cause or (self.oracles is not None and cause not in self.oracles)

    def counts_degree(self, degree: Accountability) -> bool:
        """Returns whether violations of a degree of accountability count."""
        return degree in COUNTED[self.counts]

    def is_failure(self, verdict: Verdict, agents: Mapping[str, str] | None = None) -> bool:
        """Returns whether a verdict is a failure.

        Args:
            verdict: The verdict.
            agents: The ADS of each ego, by the ego's id, for what is known of some ADSs.
        """
        return (
            self.looks_at(verdict)
            and self.counts_degree(accountability(verdict))
            and not self.knows(verdict.oracle, verdict.ego, verdict.counterpart, agents or {})
        )

    def failures(
        self, verdicts: Iterable[Verdict], agents: Mapping[str, str] | None = None
    ) -> tuple[Verdict, ...]:
        """Returns the failures among verdicts, in their order."""
        return tuple(verdict for verdict in verdicts if self.is_failure(verdict, agents))

    def is_preventable(self, verdicts: Iterable[Verdict]) -> bool:
        """Returns whether a violation is not the fault of the ego, but avoidable, counted or not.

        Args:
            verdicts: Verdicts of a run.
        """
        return any(
            accountability(verdict) is Accountability.PREVENTABLE
            for verdict in verdicts
            if self.looks_at(verdict)
        )

    def strongest(self, verdicts: Iterable[Verdict]) -> Accountability | None:
        """Returns the strongest degree of the violations that it looks at, counted or not."""
        return strongest(verdict for verdict in verdicts if self.looks_at(verdict))

    def knows(self, oracle: str, ego: str, counterpart: str, agents: Mapping[str, str]) -> bool:
        """Returns whether a failure is known and does not count."""
        driven_by = agents_of(ego, agents)
        return any(
            known.is_of(driven_by) and known.covers(oracle, ego, counterpart)
            for known in self.known
        )

    def __str__(self) -> str:
        """Returns it in words."""
        oracles = (
            "all oracles but observations"
            if self.oracles is None
            else ", ".join(one.replace("_", " ") for one in self.oracles)
        )
        known = "" if not self.known else f"; {len(self.known)} known do not count"
        return f"violations {_DEGREES_IN_WORDS[self.counts]} ({self.counts}), of {oracles}{known}"

    def _names(self, verdict: Verdict) -> bool:
        if self.oracles is None:
            return verdict.severity is not Severity.OBSERVATION
        return verdict.oracle in self.oracles


DEFAULT_DEFINITION = FailureDefinition()
"""What counts where nothing else is said."""


def requested_definition(
    counts: Counted | None, oracles: Collection[str]
) -> FailureDefinition | None:
    """Returns the definition of a request; ``None`` if it asks for none.

    Args:
        counts: The violations that count; ``None``: not asked for.
        oracles: The only oracles that count; empty: not asked for.
    """
    if counts is None and not oracles:
        return None
    return FailureDefinition(
        counts=counts or Counted.ACCOUNTABLE, oracles=tuple(sorted(set(oracles))) or None
    )


def agents_of(ego: str, agents: Mapping[str, str]) -> frozenset[str]:
    """Returns the ADS of an ego; those of all egos if a failure is of none."""
    if ego and ego in agents:
        return frozenset({agents[ego]})
    # A run that ended before its egos were known has the names of all ADSs in one text.
    return frozenset(name for names in agents.values() for name in names.split(","))


class DefinitionOrigin(StrEnum):
    """Who defined what counts."""

    REQUEST = "request"
    """The request, or the option of a command."""
    POSTED = "posted"
    """The suite, campaign or request with which the runs were posted."""
    DEFAULT = "default"
    """The default."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StatedDefinition(Shape):
    """The definition behind numbers.

    Attributes:
        words: It in words.
        origin: Who defined it.
        counts: The violations that count; null if that differs between the scenarios.
        oracles: The only oracles that count; null: all but observations, or it differs.
        definitions: Number of different definitions of the scenarios.
    """

    words: str
    origin: DefinitionOrigin
    counts: Counted | None
    oracles: tuple[str, ...] | None
    definitions: int = 1


def state_definition(
    definitions: Iterable[FailureDefinition], origin: DefinitionOrigin | None = None
) -> StatedDefinition:
    """Returns what is stated beside numbers over runs with these definitions.

    Args:
        definitions: Those of the runs; without any, the default.
        origin: Who defined them; ``None``: those who posted the runs, unless it is the default.
    """
    different = list(dict.fromkeys(definitions)) or [DEFAULT_DEFINITION]
    is_default = different == [DEFAULT_DEFINITION]
    counts = {one.counts for one in different}
    oracles = {one.oracles for one in different}
    words = "; or ".join(map(str, different[:_MOST_IN_WORDS]))
    more = len(different) - _MOST_IN_WORDS
    return StatedDefinition(
        words=f"{words}; or {more} more" if more > 0 else words,
        origin=origin or (DefinitionOrigin.DEFAULT if is_default else DefinitionOrigin.POSTED),
        counts=counts.pop() if len(counts) == 1 else None,
        oracles=oracles.pop() if len(oracles) == 1 else None,
        definitions=len(different),
    )


def definition_to_json(definition: FailureDefinition) -> str:
    """Writes a definition as it is stored with runs and batches; "" for the default."""
    if definition == DEFAULT_DEFINITION:
        return ""
    return adapter(FailureDefinition).dump_json(definition, exclude_defaults=True).decode()


@lru_cache(maxsize=1024)
def definition_from_json(text: str) -> FailureDefinition:
    """Reads what :func:`definition_to_json` wrote."""
    if not text:
        return DEFAULT_DEFINITION
    definition: FailureDefinition = adapter(FailureDefinition).validate_json(text)
    return definition


def definition_of(document: Mapping[str, Any]) -> FailureDefinition:
    """Returns what a stored campaign or study counts, from the content of its document."""
    oracles = document.get("oracles")
    return FailureDefinition(
        counts=Counted(document.get("counts") or Counted.ACCOUNTABLE),
        oracles=None if oracles is None else tuple(sorted(oracles)),
    )


@lru_cache(maxsize=256)
def definition_of_document(text: str) -> FailureDefinition:
    """Returns what a stored campaign or study counts, from the JSON of its document."""
    return definition_of(from_json(text))
