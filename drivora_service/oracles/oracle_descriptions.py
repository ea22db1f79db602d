"""What each built-in oracle says about itself: definition, unit, direction, thresholds, source.

The classes describe metrics and objectives as well; see ``metrics.metric_descriptions`` and
``feedback.objective_descriptions``.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from drivora_service.oracles.verdict import Severity
from drivora_service.shapes import Shape

SHARE = "1"
"""The unit of shares and scores."""

_LEADERBOARD = "CARLA Leaderboard"
_NUPLAN = "nuPlan"
_OWN = "Drivora"
_DECICTOR = "Decictor (Cheng et al. 2025)"


class ViolatedBy(StrEnum):
    """The direction in which an oracle's measure violates it."""

    ABOVE = "above"
    BELOW = "below"
    EVENT = "event"
    """It happens or not; there is no measure to compare."""


class Better(StrEnum):
    """The direction in which a metric is better."""

    HIGHER = "higher"
    LOWER = "lower"
    NEITHER = "neither"
    """It describes the run; more is neither better nor worse."""


class MeasureKind(StrEnum):
    """Whether a value describes a run, or guides a search."""

    METRIC = "metric"
    OBJECTIVE = "objective"
    """Minimised by searches: the smaller one is nearer to a failure."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ThresholdDescription(Shape):
    """A threshold of an oracle.

    Attributes:
        unit: SI unit; `1` for a share.
        meaning: One sentence.
        source: Where its default comes from.
    """

    name: str
    unit: str
    meaning: str
    source: str


@dataclass(frozen=True, slots=True, kw_only=True)
class OracleDescription(Shape):
    """What an oracle says about itself.

    Attributes:
        severity: The greatest severity of its violations; observations count only where a
            definition of failures names the oracle.
        definition: One sentence.
        unit: Unit of what it measures; empty if it only happens or not.
        violated_by: Direction in which the measure violates it.
        thresholds: One for each of its parameters.
        source: Where the definition comes from.
    """

    name: str
    severity: Severity
    definition: str
    unit: str
    violated_by: ViolatedBy
    thresholds: tuple[ThresholdDescription, ...]
    source: str


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasureDescription(Shape):
    """What a metric or an objective says about itself.

    Attributes:
        definition: One sentence.
        unit: SI unit; `1` for a share or a score.
        better: Direction in which it is better for the ADS.
        feedback: Feedback that measures the objective; empty for a metric, and for the objective
            of a law or an oracle.
        several_egos: How the values of several egos become that of the run: `mean`, `least`, `most`
            or `all`, where the value is that of all egos together.
        threshold: What it is compared with, in words; empty if with nothing.
        source: Where the formula comes from.
    """

    name: str
    kind: MeasureKind
    feedback: str
    definition: str
    unit: str
    better: Better
    several_egos: str
    threshold: str
    source: str


def _threshold(name: str, unit: str, meaning: str, source: str) -> ThresholdDescription:
    return ThresholdDescription(name=name, unit=unit, meaning=meaning, source=source)


def find_description(name: str) -> OracleDescription | None:
    """Returns the description of a built-in oracle; ``None`` for one of a package."""
    return next((one for one in ORACLES if one.name == name), None)


ORACLES = (
    OracleDescription(
        name="collision",
        severity=Severity.MAJOR,
        definition="The box of the ego overlaps that of another actor; the same actor counts once.",
        unit="",
        violated_by=ViolatedBy.EVENT,
        thresholds=(
            _threshold("standing_speed", "m/s", "An actor this slow or slower stands.", _NUPLAN),
            _threshold(
                "off_road",
                "m",
                "The ego is beside the road for nuPlan's rule of fault beyond this distance.",
                _NUPLAN,
            ),
        ),
        source="Overlap of oriented boxes; fault by Drivora's table of rules, from nuPlan, RSS, "
        "UN R157 and the Vienna Convention",
    ),
    OracleDescription(
        name="red_light",
        severity=Severity.MAJOR,
        definition="The tail of the ego crosses a stop line while the signal of its movement is "
        "red.",
        unit="",
        violated_by=ViolatedBy.EVENT,
        thresholds=(
            _threshold(
                "seen_within",
                "m",
                "The front must have been this near before the line, or the line is not the ego's.",
                _LEADERBOARD,
            ),
        ),
        source=_LEADERBOARD,
    ),
    OracleDescription(
        name="stop_sign",
        severity=Severity.MAJOR,
        definition="The front of the ego crosses the line of a stop sign without having stood "
        "before it.",
        unit="m/s",
        violated_by=ViolatedBy.ABOVE,
        thresholds=(
            _threshold("standing_speed", "m/s", "Slower than this, the ego stands.", _LEADERBOARD),
            _threshold("window", "s", "The ego must have stood for this long.", _OWN),
            _threshold(
                "reach", "m", "The ego must have stood this near before the line.", _LEADERBOARD
            ),
        ),
        source=f"{_LEADERBOARD}; stop signs and all-way stops are those of the SUMO network",
    ),
    OracleDescription(
        name="failure_to_yield",
        severity=Severity.MAJOR,
        definition="The ego goes before an actor that has the right of way, and hinders it.",
        unit="s",
        violated_by=ViolatedBy.BELOW,
        thresholds=(
            _threshold(
                "encroachment",
                "s",
                "The other is hindered if it reaches the place this soon after the ego left it.",
                "Allen, Shin and Cooper 1978; Peesapati et al. 2018",
            ),
            _threshold(
                "braking",
                "m/s²",
                "The other is hindered if it brakes this hard for the ego in the junction.",
                "nuPlan's bound of comfort; RSS's least braking",
            ),
            _threshold(
                "attention", "s", "Others count that come this soon after the ego has passed.", _OWN
            ),
        ),
        source="Right of way of the SUMO network; post-encroachment time",
    ),
    OracleDescription(
        name="off_road",
        severity=Severity.MAJOR,
        definition="A corner of the ego leaves the lanes and junctions that cars may use, deep or "
        "for long enough.",
        unit="m",
        violated_by=ViolatedBy.ABOVE,
        thresholds=(
            _threshold("tolerance", "m", "A corner may be this far outside.", _NUPLAN),
            _threshold("duration", "s", "It must be further outside for this long.", _OWN),
            _threshold(
                "severe_distance",
                "m",
                "From this on it violates, however short.",
                "Leaderboard's margin beyond a lane",
            ),
        ),
        source=_NUPLAN,
    ),
    OracleDescription(
        name="wrong_way",
        severity=Severity.MAJOR,
        definition="The ego moves against the direction of the lane that it is on, outside "
        "junctions.",
        unit="m",
        violated_by=ViolatedBy.ABOVE,
        thresholds=(
            _threshold("window", "s", "The movement is summed over this time.", _NUPLAN),
            _threshold("distance", "m", "More than this within the window violates.", _NUPLAN),
            _threshold("severe_distance", "m", "From this on it is marked as severe.", _NUPLAN),
        ),
        source=_NUPLAN,
    ),
    OracleDescription(
        name="lane_keeping",
        severity=Severity.MINOR,
        definition="The centre of the ego leaves all lanes, or is in a lane of the other "
        "direction.",
        unit="m",
        violated_by=ViolatedBy.ABOVE,
        thresholds=(
            _threshold(
                "margin", "m", "So far beyond the edge of a lane counts as inside.", _LEADERBOARD
            ),
            _threshold("least_distance", "m", "Shorter stays outside do not count.", _OWN),
            _threshold("least_time", "s", "Stays outside that last less do not count.", _OWN),
        ),
        source=_LEADERBOARD,
    ),
    OracleDescription(
        name="route_deviation",
        severity=Severity.MINOR,
        definition="The ego is far from its route, or has driven beside it for a great part of "
        "its length.",
        unit="m",
        violated_by=ViolatedBy.ABOVE,
        thresholds=(
            _threshold("far", "m", "Further from the route violates at once.", _LEADERBOARD),
            _threshold(
                "beside", "m", "Further from the route, the ego drives beside it.", _LEADERBOARD
            ),
            _threshold(
                "share",
                SHARE,
                "More of the route's length driven beside it violates.",
                _LEADERBOARD,
            ),
        ),
        source=_LEADERBOARD,
    ),
    OracleDescription(
        name="speeding",
        severity=Severity.MINOR,
        definition="The ego is faster than its lane allows for longer than is excused.",
        unit="m/s",
        violated_by=ViolatedBy.ABOVE,
        thresholds=(
            _threshold("excess", SHARE, "The limit may be exceeded by this share of it.", _OWN),
            _threshold("duration", "s", "A faster ego is excused for this long.", _OWN),
        ),
        source=_OWN,
    ),
    OracleDescription(
        name="blocked",
        severity=Severity.MINOR,
        definition="The ego stands for long, and no signal makes it wait.",
        unit="s",
        violated_by=ViolatedBy.ABOVE,
        thresholds=(
            _threshold("standing_speed", "m/s", "Slower than this, the ego stands.", _LEADERBOARD),
            _threshold("duration", "s", "Standing for this long violates.", "Bench2Drive"),
            _threshold(
                "queue_reach",
                "m",
                "This near before a stop line, the ego may wait for its signal.",
                _OWN,
            ),
        ),
        source="CARLA Leaderboard; Bench2Drive",
    ),
    OracleDescription(
        name="junction_blocking",
        severity=Severity.MAJOR,
        definition="The ego stands in a junction, on a way that others cross, without a reason.",
        unit="s",
        violated_by=ViolatedBy.ABOVE,
        thresholds=(
            _threshold("standing_speed", "m/s", "Slower than this, the ego stands.", _LEADERBOARD),
            _threshold("duration", "s", "Standing for this long without a reason violates.", _OWN),
            _threshold(
                "headway",
                "s",
                "A vehicle that goes first and comes this soon is a reason to wait.",
                "Highway Capacity Manual",
            ),
            _threshold(
                "waiting", "s", "Another vehicle that stands for this long waits for the ego.", _OWN
            ),
        ),
        source="Vienna Convention art. 18.5 and 18.6; StVO § 11 (1)",
    ),
    OracleDescription(
        name="deadlock",
        severity=Severity.MINOR,
        definition="Several egos stand in a cycle, each because of the next.",
        unit="s",
        violated_by=ViolatedBy.ABOVE,
        thresholds=(
            _threshold("standing_speed", "m/s", "Slower than this, an ego stands.", _OWN),
            _threshold("duration", "s", "All of them must have stood for this long.", _OWN),
            _threshold("reach", "m", "An ego waits for others this near before it.", _OWN),
            _threshold(
                "bearing", "rad", "An ego waits for others within this angle of its heading.", _OWN
            ),
        ),
        source=_OWN,
    ),
    OracleDescription(
        name="destination",
        severity=Severity.MINOR,
        definition="The ego does not arrive within the time that its route allows; waiting at "
        "signals does not count.",
        unit="s",
        violated_by=ViolatedBy.ABOVE,
        thresholds=(
            _threshold(
                "progress", SHARE, "This share of the route must lie behind it.", _LEADERBOARD
            ),
            _threshold("distance", "m", "It must be this near to the goal.", _LEADERBOARD),
            _threshold(
                "time_per_metre", "s/m", "The time that a metre of the route allows.", _LEADERBOARD
            ),
            _threshold("time_to_start", "s", "The time allowed in addition.", _LEADERBOARD),
        ),
        source=_LEADERBOARD,
    ),
    OracleDescription(
        name="near_miss",
        severity=Severity.OBSERVATION,
        definition="The ego comes so near to another actor, in time, that they almost collide.",
        unit="s",
        violated_by=ViolatedBy.BELOW,
        thresholds=(
            _threshold("time_to_collision", "s", "A shorter time to collision violates.", _NUPLAN),
            _threshold("duration", "s", "It must be shorter for this long.", _OWN),
            _threshold(
                "post_encroachment_time",
                "s",
                "A shorter post-encroachment time violates.",
                "Allen, Shin and Cooper 1978",
            ),
            _threshold("standing_speed", "m/s", "An ego this slow endangers no actor.", _OWN),
            _threshold("gap", "m", "Boxes that come this near are near.", _OWN),
        ),
        source="Time to collision (Hayward 1972) and post-encroachment time (Allen, Shin and "
        "Cooper 1978)",
    ),
    OracleDescription(
        name="tailgating",
        severity=Severity.OBSERVATION,
        definition="The ego follows a vehicle at less than the safe distance of RSS.",
        unit="m",
        violated_by=ViolatedBy.BELOW,
        thresholds=(
            _threshold("duration", "s", "It must be too near for this long.", _OWN),
            _threshold("response_time", "s", "The ego begins to brake after this time.", "UN R157"),
            _threshold("acceleration", "m/s²", "The ego speeds up by this much until then.", _OWN),
            _threshold("own_braking", "m/s²", "The ego brakes this hard.", "UN R13-H"),
            _threshold("other_braking", "m/s²", "The vehicle ahead brakes this hard.", "UN R157"),
            _threshold("reach", "m", "A vehicle this far ahead is not followed.", _OWN),
        ),
        source="Responsibility-sensitive safety, definition 1 (Shalev-Shwartz, Shammah and Shashua "
        "2017)",
    ),
    OracleDescription(
        name="minimum_speed",
        severity=Severity.OBSERVATION,
        definition="The ego is slow although neither traffic, signals, junctions nor bends ask for "
        "it.",
        unit="m/s",
        violated_by=ViolatedBy.BELOW,
        thresholds=(
            _threshold("share", SHARE, "Below this share of the limit, the ego is slow.", _OWN),
            _threshold("duration", "s", "It must be slow for this long.", _OWN),
            _threshold("ahead", "m", "An actor this near in its way is a reason.", _OWN),
            _threshold("junction", "m", "A stop line or the goal this near is a reason.", _OWN),
            _threshold("start", "s", "The first seconds do not count.", _LEADERBOARD),
            _threshold(
                "lateral_acceleration",
                "m/s²",
                "A bend in which more speed would need more is a reason.",
                _OWN,
            ),
        ),
        source="After the CARLA Leaderboard 2.0, which compares with the traffic around",
    ),
    OracleDescription(
        name="discomfort",
        severity=Severity.OBSERVATION,
        definition="An acceleration, a jerk or a rate of turning of the ego exceeds its bound of "
        "comfort.",
        unit="m/s², m/s³, rad/s, rad/s²",
        violated_by=ViolatedBy.ABOVE,
        thresholds=(
            _threshold(
                "min_longitudinal_acceleration", "m/s²", "Harder braking violates.", _NUPLAN
            ),
            _threshold(
                "max_longitudinal_acceleration", "m/s²", "Harder acceleration violates.", _NUPLAN
            ),
            _threshold(
                "max_lateral_acceleration", "m/s²", "More to either side violates.", _NUPLAN
            ),
            _threshold("max_yaw_rate", "rad/s", "Faster turning violates.", _NUPLAN),
            _threshold(
                "max_yaw_acceleration", "rad/s²", "A faster change of turning violates.", _NUPLAN
            ),
            _threshold(
                "max_longitudinal_jerk",
                "m/s³",
                "A faster change of the acceleration along the heading violates.",
                _NUPLAN,
            ),
            _threshold(
                "max_jerk", "m/s³", "A faster change of the whole acceleration violates.", _NUPLAN
            ),
        ),
        source="nuPlan's bounds of comfort, which Bench2Drive shares",
    ),
    OracleDescription(
        name="non_optimal_decision",
        severity=Severity.MINOR,
        definition="The ego arrives on another path than its reference path, which was free.",
        unit=SHARE,
        violated_by=ViolatedBy.BELOW,
        thresholds=(
            _threshold("overlap", SHARE, "Paths that share no more are different.", _DECICTOR),
            _threshold("piece", "m", "Paths are compared in pieces of this length.", _DECICTOR),
            _threshold("half_width", "m", "A piece this near to the other path is shared.", _OWN),
            _threshold(
                "ends", "m", "Paths that begin or end further apart are not compared.", _OWN
            ),
        ),
        source=_DECICTOR,
    ),
)
"""The built-in oracles in the order of judging."""
