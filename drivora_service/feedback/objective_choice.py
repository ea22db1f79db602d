"""Objectives that a campaign chooses, and how they become what a tester minimises."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

WEIGHTED_SUM = "weighted_sum"
"""Name of the objective that weighs others."""

NOT_MEASURABLE = 1.0
"""Share of an objective that is not measurable: beyond all that are."""


class ObjectiveKind(StrEnum):
    """What measures an objective."""

    FEEDBACK = "feedback"
    METRIC = "metric"
    ORACLE = "oracle"
    LAW = "law"


@dataclass(frozen=True, slots=True, kw_only=True)
class ObjectiveChoice:
    """An objective that a campaign has chosen.

    Attributes:
        name: Name under which its value is stored.
        kind: What measures it.
        owner: The feedback, oracle or law; "" for a metric.
        member: Its name where it is measured.
        parameters: Parameters of the feedback.
        negated: Whether what is measured is to be maximised: its negative is minimised.
        target: Value of the objective at and below which it is reached; ``None``: none is known.
        scale: Distance from the target, in the unit of the objective, that is half of the way from
            a failure to the worst.
        weight: Its weight in the weighted sum; ``None``: it is an objective by itself.
    """

    name: str
    kind: ObjectiveKind
    owner: str = ""
    member: str
    parameters: Mapping[str, Any] = field(default_factory=dict)
    negated: bool = False
    target: float | None = None
    scale: float = 1.0
    weight: float | None = None


def share_of(value: float, *, target: float | None, scale: float) -> float:
    """Maps an objective to -1..1: 0 at its target, one half at the scale, never saturated.

    Source: Arcuri, "It really does matter how you normalize the branch distance in search-based
    software testing" (2013).
    """
    away = value - (target or 0.0)
    return away / (abs(away) + scale)


def combine_objectives(
    choices: Sequence[ObjectiveChoice], values: Mapping[str, float | None]
) -> dict[str, float | None]:
    """Returns what a tester minimises, first, and then the parts of a weighted sum.

    Args:
        choices: The chosen objectives; either all of them or none have a weight.
        values: Their values by name.
    """
    if all(one.weight is None for one in choices):
        return dict(values)
    known = [values[one.name] is not None for one in choices]
    if not any(known):
        return {WEIGHTED_SUM: None, **values}
    total = sum(one.weight or 0.0 for one in choices)
    weighed = 0.0
    for one in choices:
        value = values[one.name]
        share = (
            NOT_MEASURABLE if value is None else share_of(value, target=one.target, scale=one.scale)
        )
        weighed += (one.weight or 0.0) * share
    return {WEIGHTED_SUM: weighed / total, **values}
