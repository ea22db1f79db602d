"""What each metric says about itself."""

from __future__ import annotations

from drivora_service.oracles.oracle_descriptions import (
    SHARE,
    Better,
    MeasureDescription,
    MeasureKind,
)

_PER_CENT = "%"
_LEADERBOARD = "CARLA Leaderboard"


def _metric(
    name: str,
    definition: str,
    *,
    unit: str,
    better: Better,
    several_egos: str,
    source: str,
    threshold: str = "",
) -> MeasureDescription:
    return MeasureDescription(
        name=name,
        kind=MeasureKind.METRIC,
        feedback="",
        definition=definition,
        unit=unit,
        better=better,
        several_egos=several_egos,
        threshold=threshold,
        source=source,
    )


METRICS = (
    _metric(
        "driving_score",
        "Route completion times the infraction penalty, by the rules of version 2.1.",
        unit=_PER_CENT,
        better=Better.HIGHER,
        several_egos="mean",
        source=f"{_LEADERBOARD} 2.1",
    ),
    _metric(
        "route_completion",
        "The share of the route that the ego drove before it arrived, left the route or ended.",
        unit=_PER_CENT,
        better=Better.HIGHER,
        several_egos="mean",
        source=_LEADERBOARD,
    ),
    _metric(
        "infraction_penalty",
        "One without infractions, and less with each, by the rules of version 2.1.",
        unit=SHARE,
        better=Better.HIGHER,
        several_egos="mean",
        source=f"{_LEADERBOARD} 2.1",
    ),
    _metric(
        "driving_score_1_0",
        "Route completion times the infraction penalty, by the rules of version 1.0.",
        unit=_PER_CENT,
        better=Better.HIGHER,
        several_egos="mean",
        source=f"{_LEADERBOARD} 1.0",
    ),
    _metric(
        "driving_score_2_0",
        "Route completion times the infraction penalty, by the rules of version 2.0.",
        unit=_PER_CENT,
        better=Better.HIGHER,
        several_egos="mean",
        source=f"{_LEADERBOARD} 2.0",
    ),
    _metric(
        "success",
        "One if the ego arrived without an infraction, else zero; slowness is none, nor is what "
        "only the oracles off_road and wrong_way forbid.",
        unit=SHARE,
        better=Better.HIGHER,
        several_egos="least",
        source="Bench2Drive",
    ),
    _metric(
        "comfort",
        "The share of segments of 20 rows in which no signal of the motion exceeds its bound.",
        unit=SHARE,
        better=Better.HIGHER,
        several_egos="mean",
        threshold="the bounds of the oracle discomfort",
        source="Bench2Drive",
    ),
    _metric(
        "efficiency",
        "The speed of the ego as a percentage of that of the moving vehicles around it, averaged "
        "over those of 20 sections of the route that it has left.",
        unit=_PER_CENT,
        better=Better.HIGHER,
        several_egos="mean",
        threshold="vehicles within 50 m; sections above 1,000 % are left out",
        source="Bench2Drive",
    ),
    _metric(
        "nuplan_closed_loop",
        "The product of the multipliers (no collision at fault, drivable area, driving direction, "
        "making progress) times the weighted mean of progress (5), time to collision (5), speed "
        "limit (4) and comfort (2), with a computed free drive in place of the expert's log.",
        unit=SHARE,
        better=Better.HIGHER,
        several_egos="mean",
        source="nuPlan, closed loop, with a free drive as the reference",
    ),
    _metric(
        "nuplan_no_at_fault_collision",
        "One without a collision at fault, a half for one with an object, else zero.",
        unit=SHARE,
        better=Better.HIGHER,
        several_egos="mean",
        source="nuPlan, closed loop; its own rule of fault",
    ),
    _metric(
        "nuplan_drivable_area",
        "One if the ego stayed on the road, else zero.",
        unit=SHARE,
        better=Better.HIGHER,
        several_egos="mean",
        threshold="0.3 m outside at any moment",
        source="nuPlan, closed loop",
    ),
    _metric(
        "nuplan_driving_direction",
        "One if the ego kept the direction of its lanes, a half if not, zero if it went far.",
        unit=SHARE,
        better=Better.HIGHER,
        several_egos="mean",
        threshold="2 m and 6 m against the lane within 1 s",
        source="nuPlan, closed loop",
    ),
    _metric(
        "nuplan_making_progress",
        "One if the ego advanced along its route at least by a share of what a computed free drive "
        "does in the same time, else zero.",
        unit=SHARE,
        better=Better.HIGHER,
        several_egos="mean",
        threshold="a fifth of the free drive's progress",
        source="nuPlan, closed loop, with a free drive as the reference",
    ),
    _metric(
        "nuplan_progress_to_free_flow",
        "What the ego advanced along its route, as a share of what a computed drive at the speed "
        "limits, without other actors, does in the same time, which stands in for the expert's log "
        "of nuPlan; both stop at the signals at which the ego stood, without counting that time.",
        unit=SHARE,
        better=Better.HIGHER,
        several_egos="mean",
        threshold="up to 2 m count as 2 m; at most 1",
        source="nuPlan, closed loop, with a free drive as the reference",
    ),
    _metric(
        "nuplan_time_to_collision",
        "One if the box of the ego would have met no other ahead within a short time at constant "
        "velocities (in junctions, between lanes and off the road also none beside), and the ego "
        "had no collision at fault, else zero.",
        unit=SHARE,
        better=Better.HIGHER,
        several_egos="mean",
        threshold="0.95 s, sampled every 0.1 s",
        source="nuPlan, closed loop",
    ),
    _metric(
        "nuplan_speed_limit",
        "One less the mean speed above the limit over a reference, at least zero.",
        unit=SHARE,
        better=Better.HIGHER,
        several_egos="mean",
        threshold="2.23 m/s above the limit give zero",
        source="nuPlan, closed loop",
    ),
    _metric(
        "nuplan_comfort",
        "One if no signal of the motion exceeded its bound, else zero.",
        unit=SHARE,
        better=Better.HIGHER,
        several_egos="mean",
        threshold="the bounds of the oracle discomfort",
        source="nuPlan, closed loop",
    ),
    _metric(
        "min_gap_m",
        "The least distance between the box of the ego and that of another actor.",
        unit="m",
        better=Better.HIGHER,
        several_egos="least",
        source="Drivora",
    ),
    _metric(
        "min_time_to_collision_s",
        "The least time until the boxes would touch if both actors kept their velocities.",
        unit="s",
        better=Better.HIGHER,
        several_egos="least",
        threshold="not measurable beyond 10 s",
        source="Hayward 1972, with oriented boxes",
    ),
    _metric(
        "post_encroachment_time_s",
        "The least time between one actor leaving a place and the other reaching it, where their "
        "paths cross.",
        unit="s",
        better=Better.HIGHER,
        several_egos="least",
        threshold="paths that cross at 30° or more; not measurable beyond 5 s",
        source="Allen, Shin and Cooper 1978",
    ),
    _metric(
        "max_drac_mps2",
        "The greatest deceleration with which the ego avoids the actor ahead, if that keeps its "
        "speed.",
        unit="m/s²",
        better=Better.LOWER,
        several_egos="most",
        source="Deceleration rate to avoid a crash (Cooper and Ferguson 1976)",
    ),
    _metric(
        "max_required_deceleration_mps2",
        "The greatest deceleration with which the ego avoids the actor ahead, if that brakes on "
        "until it stands.",
        unit="m/s²",
        better=Better.LOWER,
        several_egos="most",
        source="Deceleration rate to avoid a crash, with the braking of the actor ahead",
    ),
    _metric(
        "rss_violation_share",
        "The share of the time in which the ego is nearer to the actor ahead than RSS allows.",
        unit=SHARE,
        better=Better.LOWER,
        several_egos="mean",
        threshold="response time 1 s; 3.5, 4 and 8 m/s²",
        source="Responsibility-sensitive safety (Shalev-Shwartz, Shammah and Shashua 2017)",
    ),
    _metric(
        "distance_m",
        "The length of the path that the ego drove.",
        unit="m",
        better=Better.NEITHER,
        several_egos="mean",
        source="Drivora",
    ),
    _metric(
        "duration_s",
        "The time from the start of the ego to its end.",
        unit="s",
        better=Better.NEITHER,
        several_egos="most",
        source="Drivora",
    ),
    _metric(
        "mean_speed_mps",
        "The distance that the ego drove over the time that it took.",
        unit="m/s",
        better=Better.NEITHER,
        several_egos="mean",
        source="Drivora",
    ),
    _metric(
        "standing_time_s",
        "The longest time for which the ego stood without a signal to wait for.",
        unit="s",
        better=Better.LOWER,
        several_egos="most",
        threshold="slower than 0.1 m/s, as the oracle blocked",
        source="Drivora",
    ),
)
"""The metrics in the order of measuring."""
