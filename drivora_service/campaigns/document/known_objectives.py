"""All that a search can minimise: objectives of feedbacks and oracles, metrics, laws."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.feedback.objective_choice import ObjectiveChoice, ObjectiveKind
from drivora_service.oracles.oracle_descriptions import Better

LAW_TARGET = -1e-9
"""Target of a law's robustness, which is violated below 0: many formulas are 0 at a standstill."""

_WITHOUT_TARGET = frozenset({"driving_quality", "decisions", "conflicts", "consistency"})
"""Objectives of built-in feedbacks of which no value is a failure; of the others 0 is."""

_LAWS = "lawbreaker"


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownObjective:
    """What a search can minimise.

    Attributes:
        name: Its name.
        kind: What measures it.
        owner: The feedback, oracle or law; "" for a metric.
        member: Its name where it is measured.
        better: Direction that is better for the ADS; a search goes the other way.
        target: Value that is a failure; ``None``: none is known.
    """

    name: str
    kind: ObjectiveKind
    owner: str
    member: str
    better: Better = Better.HIGHER
    target: float | None = 0.0

    @property
    def qualified(self) -> str:
        """The name with that of what measures it, which is unique."""
        if self.kind in (ObjectiveKind.METRIC, ObjectiveKind.LAW):
            return f"{self.kind.value}/{self.member}"
        return f"{self.owner}/{self.member}"

    def choice(self, name: str) -> ObjectiveChoice:
        """Returns the choice of it as it is, to be stored under a name."""
        return ObjectiveChoice(
            name=name, kind=self.kind, owner=self.owner, member=self.member, target=self.target
        )


def objectives_of_feedback(name: str, objectives: Sequence[str]) -> tuple[KnownObjective, ...]:
    """Returns the objectives of a feedback."""
    return tuple(
        KnownObjective(
            name=member,
            kind=ObjectiveKind.FEEDBACK,
            owner=name,
            member=member,
            target=_target(name, member),
        )
        for member in objectives
    )


def _target(feedback: str, member: str) -> float | None:
    if feedback == _LAWS:
        return LAW_TARGET
    return None if member in _WITHOUT_TARGET else 0.0


def known_objectives(catalogues: Catalogues) -> tuple[KnownObjective, ...]:
    """Returns all that searches of this installation can minimise.

    Plug-ins that cannot be loaded are left out.
    """
    return tuple(_all(catalogues))


def _all(catalogues: Catalogues) -> Iterator[KnownObjective]:
    for name in catalogues.feedbacks.names():
        try:
            objectives = tuple(catalogues.feedbacks.create(FeedbackChoice(name=name)).objectives)
        except (Exception, SystemExit):
            # A broken package affects only campaigns that name it; they say why.
            continue
        yield from objectives_of_feedback(name, objectives)
    for oracle, declared in catalogues.oracles.objectives().items():
        for objective in declared:
            yield KnownObjective(
                name=objective.name,
                kind=ObjectiveKind.ORACLE,
                owner=oracle,
                member=objective.name,
            )
    for law in catalogues.oracles.library.names():
        yield KnownObjective(
            name=law, kind=ObjectiveKind.LAW, owner=law, member=law, target=LAW_TARGET
        )
    for metric in catalogues.metrics.descriptions():
        yield KnownObjective(
            name=metric.name,
            kind=ObjectiveKind.METRIC,
            owner="",
            member=metric.name,
            better=metric.better,
            target=None,
        )


def describe_known(known: Sequence[KnownObjective], feedbacks: Sequence[str]) -> str:
    """Returns all names in groups, for messages; the ways to violate a law as a range."""
    groups = {
        "objectives": [
            one.name for one in known if one.kind is ObjectiveKind.FEEDBACK and one.owner != _LAWS
        ],
        "oracles' objectives": [one.name for one in known if one.kind is ObjectiveKind.ORACLE],
        "metrics": [one.name for one in known if one.kind is ObjectiveKind.METRIC],
        "laws": [one.name for one in known if one.kind is ObjectiveKind.LAW],
        "ways to violate a law": _ranges(known),
        "feedbacks": list(feedbacks),
    }
    return "; ".join(
        f"{title} {', '.join(dict.fromkeys(names))}" for title, names in groups.items() if names
    )


def _ranges(known: Sequence[KnownObjective]) -> list[str]:
    counts: dict[str, int] = {}
    for one in known:
        if one.kind is ObjectiveKind.FEEDBACK and one.owner == _LAWS:
            law = one.member.rpartition("/")[0]
            counts[law] = counts.get(law, 0) + 1
    return [f"{law}/1" if count == 1 else f"{law}/1 to /{count}" for law, count in counts.items()]
