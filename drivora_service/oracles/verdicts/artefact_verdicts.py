"""Verdicts that say that the simulator spoilt a run."""

from __future__ import annotations

from collections.abc import Iterable

from drivora_service.oracles.verdict import Outcome, Verdict

ARTEFACT = "artefact"
"""Evidence of a collision that the simulator made: how the other actor came there."""


def find_artefact_verdicts(verdicts: Iterable[Verdict]) -> tuple[Verdict, ...]:
    """Returns the verdicts on egos whose part an artefact of the simulator ended."""
    return tuple(
        verdict
        for verdict in verdicts
        if verdict.outcome is Outcome.NOT_MEASURABLE and ARTEFACT in verdict.evidence
    )
