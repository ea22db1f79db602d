"""What each objective of the built-in feedbacks says about itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from drivora_service.oracles.oracle_descriptions import (
    SHARE,
    Better,
    MeasureDescription,
    MeasureKind,
)

if TYPE_CHECKING:
    from drivora_service.oracles.laws.law import Law
    from drivora_service.oracles.plugin import OracleObjective

_OWN = "Drivora"
_AVFUZZER = "AV-Fuzzer (Li et al. 2020)"
_BEHAVEXPLOR = "BehAVExplor (Cheng et al. 2023)"
_DECICTOR = "Decictor (Cheng et al. 2025)"
_DEEPCOLLISION = "DeepCollision (Lu et al. 2022)"
_DOPPELTEST = "DoppelTest (Huai et al. 2023)"
_DRIVEFUZZ = "DriveFuzz (Kim et al. 2022)"
_LAWBREAKER = "LawBreaker (Sun et al. 2022)"
_SAMOTA = "SAMOTA (Ul Haq, Shin and Briand 2022)"


def _objective(
    feedback: str,
    name: str,
    definition: str,
    *,
    source: str,
    unit: str = SHARE,
    better: Better = Better.HIGHER,
    several_egos: str = "least",
    threshold: str = "",
) -> MeasureDescription:
    # Most are distances from a failure: for the ADS, more is better.
    return MeasureDescription(
        name=name,
        kind=MeasureKind.OBJECTIVE,
        feedback=feedback,
        definition=definition,
        unit=unit,
        better=better,
        several_egos=several_egos,
        threshold=threshold,
        source=source,
    )


OBJECTIVES = (
    _objective(
        "general",
        "min_gap",
        "The least gap to another actor as a share of a distance that is far.",
        threshold="10 m are far",
        source=_OWN,
    ),
    _objective(
        "general",
        "time_to_collision",
        "The least time to collision as a share of a time that is long.",
        threshold="10 s are long",
        source=_OWN,
    ),
    _objective("general", "progress", "The share of the route that the ego drove.", source=_OWN),
    _objective(
        "general",
        "stuck_time",
        "One less the longest standstill as a share of the time that blocks.",
        threshold="60 s block",
        source=_OWN,
    ),
    _objective(
        "general",
        "goal_distance",
        "One less the distance from the goal at the end as a share of the length of the route.",
        source=_OWN,
    ),
    _objective(
        "avfuzzer",
        "safety_margin",
        "The mean of the least gap and the least safety potential, which is a gap less the "
        "stopping distance of the follower.",
        unit="m",
        threshold="130 m at most",
        source=_AVFUZZER,
    ),
    _objective(
        "behavexplor",
        "violation_degree",
        "The mean of four terms, each zero at a failure and at most one: nearness to the goal, and "
        "the least gaps to other actors, to the line on the left and to the edge of the road.",
        source=_BEHAVEXPLOR,
    ),
    _objective(
        "samota",
        "lane_centre",
        "How near the ego stayed to the centre of its lane; zero where it left its lane.",
        source=_SAMOTA,
    ),
    _objective(
        "samota",
        "vehicle_distance",
        "The least gap to a vehicle, mapped to a share; zero where the boxes touch.",
        threshold="10 m give one half",
        source=_SAMOTA,
    ),
    _objective(
        "samota",
        "walker_distance",
        "The least gap to a walker, mapped to a share; zero where the boxes touch.",
        threshold="10 m give one half",
        source=_SAMOTA,
    ),
    _objective(
        "samota",
        "static_distance",
        "The least gap to an obstacle, mapped to a share; zero where the boxes touch.",
        threshold="10 m give one half",
        source=_SAMOTA,
    ),
    _objective(
        "samota",
        "progress",
        "The time to spare at the average pace as a share of the time limit; zero where the ego "
        "did not arrive in time.",
        source=_SAMOTA,
    ),
    _objective(
        "samota",
        "red_light",
        "The least time before running a red light, mapped to a share; zero where the ego ran one.",
        threshold="3 s give one half",
        source=_SAMOTA,
    ),
    _objective(
        "doppeltest",
        "ego_distance",
        "The least gap between two egos.",
        unit="m",
        source=_DOPPELTEST,
    ),
    _objective(
        "doppeltest",
        "decisions",
        "The negated number of different decisions that all egos took.",
        better=Better.NEITHER,
        several_egos="all",
        source=_DOPPELTEST,
    ),
    _objective(
        "doppeltest",
        "conflicts",
        "The negated number of pairs of different routes that meet in a junction.",
        better=Better.NEITHER,
        several_egos="all",
        source=_DOPPELTEST,
    ),
    _objective(
        "drivefuzz",
        "driving_quality",
        "The negated sum of the frames in which the ego accelerated, braked or turned hard, "
        "oversteered or understeered, and of the inverse of its least distance to another actor "
        "in metres.",
        threshold="20 frames a second; hard from 5.9 m/s² along and 4.9 m/s² across",
        source=_DRIVEFUZZ,
    ),
    _objective(
        "deepcollision",
        "safety",
        "One less the greatest probability of a collision, by distances from other actors as a "
        "share of safety distances; zero for a collision.",
        source=_DEEPCOLLISION,
    ),
    _objective(
        "decictor",
        "consistency",
        "The negative difference of path and motion from those of the reference; at most zero.",
        unit="m",
        source=_DECICTOR,
    ),
)
"""The objectives, feedback by feedback."""


def oracle_objectives(
    declared: Mapping[str, Sequence[OracleObjective]],
) -> tuple[MeasureDescription, ...]:
    """Returns the objectives of oracles of packages, which are given by oracle."""
    return tuple(
        _objective(
            "",
            objective.name,
            objective.description,
            source=f"the oracle {oracle}",
            unit=objective.unit,
            threshold="0",
        )
        for oracle, objectives in declared.items()
        for objective in objectives
    )


def law_objectives(laws: Sequence[Law]) -> tuple[MeasureDescription, ...]:
    """Returns the objectives of laws: their robustness, and one for each way to violate them.

    The latter are those of LawBreaker's feedback.
    """
    # Imported here: it needs the code of laws.
    from drivora_service.feedback.lawbreaker import objectives_of

    whole = [
        _objective(
            "",
            law.name,
            f"The least robustness of the law, below zero where it is violated: {law.title}.",
            threshold="0",
            source=law.source,
        )
        for law in laws
    ]
    ways = [
        _objective(
            "lawbreaker",
            name,
            f"The negated robustness of a way to violate {law.name}, below zero where a run shows "
            f"it: {case}.",
            threshold="0",
            source=_LAWBREAKER,
        )
        for law in laws
        for name, case in zip(objectives_of([law]), law.sub_violations, strict=True)
    ]
    return (*whole, *ways)
