"""Cases inside junctions: priority, signals, all-way stop, roundabout, right before left.

``signal-grid``: at d1 (400, 0) Garden Street from the north meets Second Street, which has
priority; d2 (400, 110) has signals, green for Grand Street (east-west) until 25 s, then yellow
until 28 s and red for all until 30 s; b1 (130, 0) is an all-way stop.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tests.oracles.responsibility.case import (
    AT_FAULT,
    NOT_AT_FAULT,
    UNDETERMINED,
    Car,
    Case,
    Ego,
    Other,
)
from tests.oracles.responsibility.ways import (
    Drive,
    FloatArray,
    cut,
    detour,
    lanes,
    meeting,
    shift,
    steady,
    straight,
)

GRID = "signal-grid"
PRIORITY = "RSS rule 3 (right of way); Vienna Convention art. 18.2 and 18.4"
TURNING = "Vienna Convention art. 16.1 and 18.5 (turning left: give way to oncoming traffic)"
RED = "Vienna Convention art. 23.2 (red light); nuPlan judges contacts only"
VEER = "RSS rule 1 for opposite directions; Vienna Convention art. 10.1 and 13.5"
BLOCKED = "RSS rule 3: right of way is given, not taken; Vienna Convention art. 18.7"
TOO_LATE = "UNECE R157 annex 3 (too late to brake)"


def _case(
    name: str,
    happens: str,
    expected: str,
    source: str,
    ego: Drive,
    *others: Other,
    end: tuple[float, float],
    town: str = GRID,
    lights: Mapping[str, Any] | None = None,
    seconds: float = 14.0,
) -> Case:
    return Case(
        name=name,
        happens=happens,
        expected=expected,
        source=source,
        town=town,
        egos=(Ego(drive=ego, to=end),),
        others=others,
        lights=lights,
        seconds=seconds,
    )


EAST, WEST = -1.62, 1.62
EAST_END, WEST_END, NORTH_END = (470.0, EAST), (330.0, WEST), (401.62, 60.0)


def _eastbound(y: float = EAST) -> FloatArray:
    return straight((300.0, y), (500.0, y))


def _westbound(y: float = WEST) -> FloatArray:
    return straight((505.0, y), (290.0, y))


def _from_minor() -> FloatArray:
    return lanes(GRID, "-garden_1_1", ":d1_1_0", "corner_southeast_1")


def _left_turn() -> FloatArray:
    return lanes(GRID, "south_3_1", ":d1_5_0", ":d1_7_0", "garden_1_1")


def _priority() -> list[Case]:
    return [
        _case(
            "ego-emerges-before-priority-traffic",
            "The ego turns left from the minor road; a vehicle with priority hits its side.",
            AT_FAULT,
            PRIORITY,
            meeting(_from_minor(), (400.5, 2.0), 8.0, (0.0, 5.0)),
            Car(drive=meeting(_westbound(), (401.5, WEST), 8.0, (0.0, 10.0))),
            end=EAST_END,
        ),
        _case(
            "ego-emerges-into-priority-traffic-with-its-front",
            "The ego emerges from the minor road and hits a passing vehicle with priority.",
            AT_FAULT,
            PRIORITY,
            meeting(_from_minor(), (399.3, 3.9), 8.3, (0.0, 5.0)),
            Car(drive=meeting(_westbound(), (399.0, WEST), 8.0, (0.0, 9.0))),
            end=EAST_END,
        ),
        _case(
            "vehicle-emerges-before-ego",
            "The ego has priority and hits a vehicle that comes out of the minor road.",
            NOT_AT_FAULT,
            PRIORITY,
            meeting(_westbound(), (401.5, WEST), 8.0, (0.0, 10.0)),
            Car(drive=meeting(_from_minor(), (400.5, 2.0), 8.0, (0.0, 5.0))),
            end=WEST_END,
        ),
        _case(
            "vehicle-emerges-into-egos-side",
            "The ego has priority and is hit at its side by a vehicle from the minor road.",
            NOT_AT_FAULT,
            PRIORITY,
            meeting(_westbound(), (398.5, WEST), 8.0, (0.0, 9.0)),
            Car(drive=meeting(_from_minor(), (399.3, 3.9), 8.3, (0.0, 5.0))),
            end=WEST_END,
        ),
        _case(
            "ego-turns-left-before-oncoming",
            "The ego turns left across the way of an oncoming vehicle, which hits its side.",
            AT_FAULT,
            TURNING,
            meeting(_left_turn(), (400.0, 2.5), 8.0, (0.0, 5.0)),
            Car(drive=meeting(_westbound(), (401.0, WEST), 8.1, (0.0, 10.0))),
            end=NORTH_END,
        ),
        _case(
            "ego-turns-left-into-oncoming-with-its-front",
            "The ego turns left and hits an oncoming vehicle with its front.",
            AT_FAULT,
            TURNING,
            meeting(_left_turn(), (399.5, 1.8), 8.2, (0.0, 5.0)),
            Car(drive=meeting(_westbound(), (398.5, WEST), 8.0, (0.0, 8.0))),
            end=NORTH_END,
        ),
        _case(
            "oncoming-turns-left-before-ego",
            "An oncoming vehicle turns left before the ego, which hits it with its front.",
            NOT_AT_FAULT,
            TURNING,
            meeting(_westbound(), (401.0, WEST), 8.1, (0.0, 10.0)),
            Car(drive=meeting(_left_turn(), (400.0, 2.5), 8.0, (0.0, 5.0))),
            end=WEST_END,
        ),
        _case(
            "oncoming-turns-left-into-egos-side",
            "An oncoming vehicle turns left into the side of the passing ego.",
            NOT_AT_FAULT,
            TURNING,
            meeting(_westbound(), (392.0, WEST), 8.0, (0.0, 8.0)),
            Car(drive=meeting(_left_turn(), (399.5, 1.8), 8.2, (0.0, 5.0))),
            end=WEST_END,
        ),
        _case(
            "vehicle-creeps-out-and-stops-before-ego",
            "A vehicle emerges from the minor road and stops right before the ego with priority.",
            NOT_AT_FAULT,
            PRIORITY + "; " + TOO_LATE,
            meeting(_westbound(), (402.0, WEST), 8.0, (0.0, 11.0)),
            Car(
                drive=meeting(_from_minor(), (400.3, 2.0), 7.7, (0.0, 5.0), (6.7, 5.0), (7.7, 0.0))
            ),
            end=WEST_END,
        ),
        _case(
            "ego-creeps-out-and-stops-before-priority-traffic",
            "The ego emerges from the minor road, stops in the way, and is hit at once.",
            AT_FAULT,
            PRIORITY + "; " + TOO_LATE + "; nuPlan's class is stopped ego",
            meeting(_from_minor(), (400.3, 2.0), 7.7, (0.0, 5.0), (6.7, 5.0), (7.7, 0.0)),
            Car(drive=meeting(_westbound(), (402.0, WEST), 8.4, (0.0, 11.0))),
            end=EAST_END,
        ),
        _case(
            "ego-has-blocked-the-junction",
            "The ego has stood in the junction for 5 s when a vehicle with priority hits it.",
            NOT_AT_FAULT,
            BLOCKED,
            meeting(_from_minor(), (400.3, 2.0), 4.0, (0.0, 5.0), (3.0, 5.0), (4.0, 0.0)),
            Car(drive=meeting(_westbound(), (402.0, WEST), 9.6, (0.0, 9.0))),
            end=EAST_END,
        ),
        _case(
            "ego-hits-vehicle-that-blocks-the-junction",
            "A vehicle has stood in the junction for 5 s; the ego with priority does not brake.",
            AT_FAULT,
            BLOCKED,
            meeting(_westbound(), (402.0, WEST), 9.6, (0.0, 9.0)),
            Car(
                drive=meeting(_from_minor(), (400.3, 2.0), 4.0, (0.0, 5.0), (3.0, 5.0), (4.0, 0.0))
            ),
            end=WEST_END,
        ),
        _case(
            "ego-waits-to-turn-left-and-is-hit-from-behind",
            "The ego waits in the junction to turn left; a vehicle behind runs into it.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego; RSS rule 1",
            meeting(_left_turn(), (393.6, -1.4), 5.0, (0.0, 5.0), (4.0, 5.0), (5.0, 0.0)),
            Car(drive=meeting(_eastbound(), (388.0, EAST), 8.0, (0.0, 7.0))),
            end=NORTH_END,
        ),
        _case(
            "ego-waits-to-turn-left-and-oncoming-cuts-across",
            "The ego waits in its part of the junction; an oncoming vehicle cuts its corner.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego; Vienna Convention art. 16.1",
            meeting(_left_turn(), (393.6, -1.4), 5.0, (0.0, 5.0), (4.0, 5.0), (5.0, 0.0)),
            Car(
                drive=meeting(
                    straight((505.0, WEST), (404.0, WEST), (394.0, -0.9), (388.0, WEST)),
                    (395.0, -0.6),
                    8.0,
                    (0.0, 8.0),
                )
            ),
            end=NORTH_END,
        ),
        _case(
            "ego-follows-into-slower-vehicle-in-junction",
            "In the junction the ego runs into the slower vehicle ahead of it.",
            AT_FAULT,
            "nuPlan: active front; RSS rule 1",
            meeting(_eastbound(), (398.0, EAST), 8.0, (0.0, 9.0)),
            Car(drive=meeting(_eastbound(), (401.0, EAST), 8.0, (0.0, 5.0))),
            end=EAST_END,
        ),
        _case(
            "ego-hit-from-behind-in-junction",
            "In the junction a faster vehicle runs into the ego from behind.",
            NOT_AT_FAULT,
            "nuPlan: active rear; RSS rule 1",
            meeting(_eastbound(), (401.0, EAST), 8.0, (0.0, 5.0)),
            Car(drive=meeting(_eastbound(), (398.0, EAST), 8.0, (0.0, 9.0))),
            end=EAST_END,
        ),
    ]


def _veering() -> list[Case]:
    return [
        _case(
            "ego-veers-into-oncoming-in-junction",
            "Straight on in the junction, the ego veers over into the side of an oncoming vehicle.",
            AT_FAULT,
            VEER,
            meeting(
                detour(300.0, EAST, (391.0, 401.0), 0.2, (402.0, 412.0), 500.0),
                (400.0, 0.2),
                9.0,
                (0.0, 9.0),
            ),
            Car(drive=meeting(_westbound(), (393.0, WEST), 9.0, (0.0, 9.0))),
            end=EAST_END,
        ),
        _case(
            "ego-veers-head-on-in-junction",
            "Straight on in the junction, the ego goes over into the way of an oncoming vehicle.",
            AT_FAULT,
            VEER,
            meeting(shift(300.0, EAST, 388.0, 402.0, 1.2, 430.0), (400.0, 1.0), 9.0, (0.0, 9.0)),
            Car(drive=meeting(_westbound(), (403.0, WEST), 9.0, (0.0, 9.0))),
            end=EAST_END,
        ),
        _case(
            "oncoming-veers-into-ego-in-junction",
            "An oncoming vehicle veers over in the junction and touches the ego's side.",
            NOT_AT_FAULT,
            VEER,
            meeting(_eastbound(), (407.0, EAST), 9.0, (0.0, 9.0)),
            Car(
                drive=meeting(
                    detour(505.0, WEST, (411.0, 399.0), -0.2, (398.0, 386.0), 290.0),
                    (400.0, -0.2),
                    9.0,
                    (0.0, 9.0),
                )
            ),
            end=EAST_END,
        ),
        _case(
            "oncoming-veers-head-on-in-junction",
            "An oncoming vehicle comes over in the junction and meets the ego head on.",
            NOT_AT_FAULT,
            VEER,
            meeting(_eastbound(), (397.0, EAST), 9.0, (0.0, 9.0)),
            Car(
                drive=meeting(
                    shift(505.0, WEST, 412.0, 398.0, -1.2, 370.0), (400.0, -1.0), 9.0, (0.0, 9.0)
                )
            ),
            end=EAST_END,
        ),
        _case(
            "wrong-way-driver-comes-through-junction",
            "A vehicle that drives the wrong way meets the ego head on in the junction.",
            NOT_AT_FAULT,
            VEER,
            meeting(_eastbound(), (397.0, EAST), 9.0, (0.0, 9.0)),
            Car(drive=meeting(_westbound(EAST), (403.0, EAST), 9.0, (0.0, 9.0))),
            end=EAST_END,
        ),
        _case(
            "ego-drives-through-junction-the-wrong-way",
            "The ego drives in the oncoming lane through the junction and meets a vehicle.",
            AT_FAULT,
            VEER,
            meeting(
                straight((300.0, EAST), (345.0, EAST), (365.0, WEST), (480.0, WEST)),
                (397.0, WEST),
                9.0,
                (0.0, 9.0),
            ),
            Car(drive=meeting(_westbound(), (403.0, WEST), 9.0, (0.0, 9.0))),
            end=EAST_END,
        ),
        _case(
            "ego-cuts-the-corner-of-its-left-turn",
            "The ego cuts the corner of its left turn into a vehicle that waits to come out.",
            AT_FAULT,
            "Vienna Convention art. 16.1 (turning left without entering the opposite side)",
            meeting(
                straight((300.0, EAST), (388.0, EAST), (398.0, 9.0), (400.0, 40.0)),
                (396.5, 7.5),
                8.0,
                (0.0, 8.0),
            ),
            Car(
                drive=meeting(
                    lanes(GRID, "-garden_1_1", ":d1_1_0"),
                    (398.4, 11.5),
                    6.0,
                    (0.0, 5.0),
                    (4.5, 5.0),
                    (6.0, 0.0),
                )
            ),
            end=NORTH_END,
        ),
    ]


RIGHT, LEFT = 105.12, 108.38
NORTH = 401.62
CROSS = straight((320.0, LEFT), (520.0, LEFT))
UP = straight((NORTH, 12.0), (NORTH, 205.0))
D2_EAST, D2_NORTH = (500.0, LEFT), (NORTH, 180.0)
LATER: Mapping[str, Any] = {"junctions": {"d2": {"offset": -27.0}}}
"""Yellow for Grand Street until 1 s, red for all until 3 s, green for Garden Street until 28 s."""
CHANGING: Mapping[str, Any] = {"junctions": {"d2": {"offset": -20.0}}}
"""Green for Grand Street until 5 s, red for all from 8 to 10 s, then green for Garden Street."""


def _signals() -> list[Case]:
    turn = lanes(GRID, "grand_3_2", ":d2_13_0", ":d2_21_0", "garden_2_1")
    westwards = straight((528.0, 111.62), (300.0, 111.62))
    return [
        _case(
            "ego-runs-red-and-is-hit",
            "The ego crosses on red; a vehicle on green hits its side.",
            AT_FAULT,
            RED,
            meeting(UP, (NORTH, 109.5), 8.0, (0.0, 9.0)),
            Car(drive=meeting(CROSS, (399.0, LEFT), 8.0, (0.0, 9.0))),
            end=D2_NORTH,
        ),
        _case(
            "ego-runs-red-and-hits",
            "The ego crosses on red and hits a vehicle on green with its front.",
            AT_FAULT,
            RED,
            meeting(UP, (NORTH, 105.5), 8.0, (0.0, 9.0)),
            Car(drive=meeting(CROSS, (402.0, LEFT), 8.0, (0.0, 9.0))),
            end=D2_NORTH,
        ),
        _case(
            "other-runs-red-before-ego",
            "A vehicle crosses on red before the ego on green, which hits it with its front.",
            NOT_AT_FAULT,
            RED,
            meeting(CROSS, (399.0, LEFT), 8.0, (0.0, 9.0)),
            Car(drive=meeting(UP, (NORTH, 109.5), 8.0, (0.0, 9.0))),
            end=D2_EAST,
        ),
        _case(
            "other-runs-red-into-egos-side",
            "A vehicle on red hits the side of the ego, which has green.",
            NOT_AT_FAULT,
            RED,
            meeting(CROSS, (402.0, LEFT), 8.0, (0.0, 9.0)),
            Car(drive=meeting(UP, (NORTH, 105.5), 8.0, (0.0, 9.0))),
            end=D2_EAST,
        ),
        _case(
            "both-run-red",
            "The ego and a crossing vehicle both enter while all signals are red.",
            UNDETERMINED,
            "Vienna Convention art. 23.2 binds both",
            meeting(CROSS, (400.0, LEFT), 3.3, (0.0, 12.0)),
            Car(drive=meeting(UP, (NORTH, 106.5), 3.3, (0.0, 7.0))),
            end=D2_EAST,
            lights=LATER,
        ),
        _case(
            "ego-turns-left-on-green-before-oncoming",
            "On a green that does not protect it, the ego turns left before an oncoming vehicle.",
            AT_FAULT,
            TURNING,
            meeting(turn, (399.5, 111.8), 8.0, (0.0, 6.0)),
            Car(drive=meeting(westwards, (401.0, 111.62), 8.0, (0.0, 10.0))),
            end=D2_NORTH,
        ),
        _case(
            "oncoming-turns-left-on-green-before-ego",
            "On a green that does not protect it, an oncoming vehicle turns left before the ego.",
            NOT_AT_FAULT,
            TURNING,
            meeting(westwards, (401.0, 111.62), 8.0, (0.0, 10.0)),
            Car(drive=meeting(turn, (399.5, 111.8), 8.0, (0.0, 6.0))),
            end=(330.0, 111.62),
        ),
        _case(
            "ego-clears-the-junction-and-is-hit",
            "The ego entered on green and is slow to clear; a vehicle whose green has just begun "
            "hits it.",
            NOT_AT_FAULT,
            "Vienna Convention art. 18.3 and 23.2: green does not entitle to enter before the "
            "junction is clear",
            meeting(CROSS, (400.5, LEFT), 11.5, (0.0, 3.0), (4.5, 3.0), (5.5, 1.4)),
            Car(drive=meeting(UP, (NORTH, 104.0), 11.5, (0.0, 7.0))),
            end=D2_EAST,
            lights=CHANGING,
        ),
        _case(
            "ego-on-new-green-hits-vehicle-that-clears",
            "The ego's green has just begun; it hits a slow vehicle that entered on green before.",
            AT_FAULT,
            "Vienna Convention art. 18.3 and 23.2: green does not entitle to enter before the "
            "junction is clear",
            meeting(UP, (NORTH, 104.0), 11.5, (0.0, 7.0)),
            Car(drive=meeting(CROSS, (400.5, LEFT), 11.5, (0.0, 3.0), (4.5, 3.0), (5.5, 1.4))),
            end=D2_NORTH,
            lights=CHANGING,
        ),
        _case(
            "ego-straddles-two-lanes-in-signalised-junction",
            "In the junction the ego moves over into the vehicle that goes straight on beside it.",
            AT_FAULT,
            "Vienna Convention art. 14.1; nuPlan: active lateral collision",
            steady(straight((350.0, LEFT), (394.0, LEFT), (406.0, 106.2), (500.0, 106.2)), 9.0),
            Car(drive=steady(straight((349.0, RIGHT), (500.0, RIGHT)), 9.0)),
            end=D2_EAST,
        ),
    ]


def _other_junctions() -> list[Case]:
    ring = lanes("roundabout", *RING)
    entry = lanes("roundabout", "link_3_0", "small_west_entry_0", ":small_west_in_0_0", *ENTERED)
    b1_west = straight((245.0, WEST), (30.0, WEST))
    b1_minor = lanes(GRID, "-castle_1_1", ":b1_1_0", "south_2_1")
    stop = "stop sign of an all-way stop: who stands at the line first goes first"
    town = lanes("old-town", "castle_hill_1", ":castle_0_0", "castle_street_1")
    from_left = lanes("old-town", "cloister_1", ":castle_3_0", "castle_street_1")
    return [
        _case(
            "ego-enters-roundabout-before-circulating-vehicle",
            "The ego enters the roundabout before a vehicle in it, which hits its side.",
            AT_FAULT,
            "Vienna Convention art. 18.2 (give way at the entry); RSS rule 3",
            meeting(entry, (454.8, -10.6), 8.0, (0.0, 7.0)),
            Car(drive=meeting(ring, (453.6, -7.2), 8.0, (0.0, 6.0))),
            town="roundabout",
            end=ROUND_END,
        ),
        _case(
            "vehicle-enters-roundabout-before-ego",
            "A vehicle enters the roundabout before the ego, which circulates.",
            NOT_AT_FAULT,
            "Vienna Convention art. 18.2 (give way at the entry); RSS rule 3",
            meeting(ring, (453.6, -7.2), 8.0, (0.0, 6.0)),
            Car(drive=meeting(entry, (454.8, -10.6), 8.0, (0.0, 7.0))),
            town="roundabout",
            end=ROUND_END,
        ),
        _case(
            "ego-runs-into-vehicle-in-roundabout",
            "In the roundabout the ego runs into the slower vehicle ahead.",
            AT_FAULT,
            "nuPlan: active front; RSS rule 1",
            steady(ring, 8.0),
            Car(drive=steady(cut(ring, 14.0), 3.5)),
            town="roundabout",
            end=ROUND_END,
        ),
        _case(
            "ego-from-the-left-of-a-vehicle",
            "At right before left, the ego does not give way to a vehicle from its right.",
            AT_FAULT,
            "Vienna Convention art. 18.4 (right before left)",
            meeting(from_left, (95.0, 121.5), 8.0, (0.0, 5.0)),
            Car(drive=meeting(town, (95.6, 120.5), 8.0, (0.0, 5.5))),
            town="old-town",
            end=OLD_TOWN_END,
        ),
        _case(
            "vehicle-from-the-left-of-ego",
            "At right before left, a vehicle from the left does not give way to the ego.",
            NOT_AT_FAULT,
            "Vienna Convention art. 18.4 (right before left)",
            meeting(town, (96.5, 117.0), 8.0, (0.0, 5.5)),
            Car(drive=meeting(from_left, (95.0, 121.5), 8.0, (0.0, 5.0))),
            town="old-town",
            end=OLD_TOWN_END,
        ),
        Case(
            name="ego-second-at-all-way-stop",
            happens="One ego has stopped at the all-way stop and goes; the other comes later and "
            "drives on.",
            expected=AT_FAULT,
            expected_of={"second": NOT_AT_FAULT},
            source=stop,
            town=GRID,
            egos=(
                Ego(drive=meeting(b1_west, (132.0, WEST), 9.0, (0.0, 8.0)), to=(60.0, WEST)),
                Ego(
                    drive=meeting(b1_minor, (129.8, 3.2), 9.0, *_stopping(5.0, 7.0)),
                    to=(220.0, EAST),
                    name="second",
                ),
            ),
            seconds=14.0,
        ),
        _case(
            "ego-first-at-all-way-stop",
            "The ego has stopped at the all-way stop and goes; a later vehicle does not stop.",
            NOT_AT_FAULT,
            stop,
            meeting(b1_minor, (129.8, 3.2), 9.0, *_stopping(5.0, 7.0)),
            Car(drive=meeting(b1_west, (132.0, WEST), 9.0, (0.0, 8.0))),
            end=(220.0, EAST),
        ),
        _case(
            "both-drive-through-all-way-stop",
            "The ego and a vehicle reach the all-way stop at the same time and do not stop.",
            UNDETERMINED,
            "both break the same rule, and neither was first",
            meeting(b1_west, (132.0, WEST), 8.0, (0.0, 6.5)),
            Car(drive=meeting(b1_minor, (129.8, 3.2), 8.0, (0.0, 6.5))),
            end=(60.0, WEST),
        ),
    ]


ENTERED = ("small_ring_6_0", ":small_south_out_1_0", "small_ring_7_0")
RING = (
    *("small_ring_1_0", ":small_east_in_1_0", "small_ring_2_0", ":small_north_out_1_0"),
    *("small_ring_3_0", ":small_north_in_1_0", "small_ring_4_0", ":small_west_out_1_0"),
    *("small_ring_5_0", ":small_west_in_1_0", *ENTERED),
)
ROUND_END = (471.0, -17.7)
OLD_TOWN_END = (89.4, 151.0)


def _stopping(stop: float, go: float) -> tuple[tuple[float, float], ...]:
    """At 5 m/s, a stop, and on at 4 m/s."""
    return ((0.0, 5.0), (stop - 1.5, 5.0), (stop, 0.0), (go, 0.0), (go + 1.5, 4.0))


def cases() -> list[Case]:
    """All of this kind."""
    return [*_priority(), *_veering(), *_signals(), *_other_junctions()]
