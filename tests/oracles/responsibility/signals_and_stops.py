"""Cases inside other junctions: signals, all-way stop, roundabout, right before left.

In ``signal-grid``, d2 (400, 110) has signals, green for Grand Street (east-west) until 25 s, then
yellow until 28 s and red for all until 30 s; b1 (130, 0) is an all-way stop.
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
)
from tests.oracles.responsibility.junctions import EAST, GRID, RED, TURNING, WEST, junction_case
from tests.oracles.responsibility.ways import cut, lanes, meeting, steady, straight

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
        junction_case(
            "ego-runs-red-and-is-hit",
            "The ego crosses on red; a vehicle on green hits its side.",
            AT_FAULT,
            RED,
            meeting(UP, (NORTH, 109.5), 8.0, (0.0, 9.0)),
            Car(drive=meeting(CROSS, (399.0, LEFT), 8.0, (0.0, 9.0))),
            end=D2_NORTH,
        ),
        junction_case(
            "ego-runs-red-and-hits",
            "The ego crosses on red and hits a vehicle on green with its front.",
            AT_FAULT,
            RED,
            meeting(UP, (NORTH, 105.5), 8.0, (0.0, 9.0)),
            Car(drive=meeting(CROSS, (402.0, LEFT), 8.0, (0.0, 9.0))),
            end=D2_NORTH,
        ),
        junction_case(
            "other-runs-red-before-ego",
            "A vehicle crosses on red before the ego on green, which hits it with its front.",
            NOT_AT_FAULT,
            RED,
            meeting(CROSS, (399.0, LEFT), 8.0, (0.0, 9.0)),
            Car(drive=meeting(UP, (NORTH, 109.5), 8.0, (0.0, 9.0))),
            end=D2_EAST,
        ),
        junction_case(
            "other-runs-red-into-egos-side",
            "A vehicle on red hits the side of the ego, which has green.",
            NOT_AT_FAULT,
            RED,
            meeting(CROSS, (402.0, LEFT), 8.0, (0.0, 9.0)),
            Car(drive=meeting(UP, (NORTH, 105.5), 8.0, (0.0, 9.0))),
            end=D2_EAST,
        ),
        junction_case(
            "both-run-red",
            "The ego and a crossing vehicle both enter while all signals are red.",
            UNDETERMINED,
            "Vienna Convention art. 23.2 binds both",
            meeting(CROSS, (400.0, LEFT), 3.3, (0.0, 12.0)),
            Car(drive=meeting(UP, (NORTH, 106.5), 3.3, (0.0, 7.0))),
            end=D2_EAST,
            lights=LATER,
        ),
        junction_case(
            "ego-turns-left-on-green-before-oncoming",
            "On a green that does not protect it, the ego turns left before an oncoming vehicle.",
            AT_FAULT,
            TURNING,
            meeting(turn, (399.5, 111.8), 8.0, (0.0, 6.0)),
            Car(drive=meeting(westwards, (401.0, 111.62), 8.0, (0.0, 10.0))),
            end=D2_NORTH,
        ),
        junction_case(
            "oncoming-turns-left-on-green-before-ego",
            "On a green that does not protect it, an oncoming vehicle turns left before the ego.",
            NOT_AT_FAULT,
            TURNING,
            meeting(westwards, (401.0, 111.62), 8.0, (0.0, 10.0)),
            Car(drive=meeting(turn, (399.5, 111.8), 8.0, (0.0, 6.0))),
            end=(330.0, 111.62),
        ),
        junction_case(
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
        junction_case(
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
        junction_case(
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
        junction_case(
            "ego-enters-roundabout-before-circulating-vehicle",
            "The ego enters the roundabout before a vehicle in it, which hits its side.",
            AT_FAULT,
            "Vienna Convention art. 18.2 (give way at the entry); RSS rule 3",
            meeting(entry, (454.8, -10.6), 8.0, (0.0, 7.0)),
            Car(drive=meeting(ring, (453.6, -7.2), 8.0, (0.0, 6.0))),
            town="roundabout",
            end=ROUND_END,
        ),
        junction_case(
            "vehicle-enters-roundabout-before-ego",
            "A vehicle enters the roundabout before the ego, which circulates.",
            NOT_AT_FAULT,
            "Vienna Convention art. 18.2 (give way at the entry); RSS rule 3",
            meeting(ring, (453.6, -7.2), 8.0, (0.0, 6.0)),
            Car(drive=meeting(entry, (454.8, -10.6), 8.0, (0.0, 7.0))),
            town="roundabout",
            end=ROUND_END,
        ),
        junction_case(
            "ego-runs-into-vehicle-in-roundabout",
            "In the roundabout the ego runs into the slower vehicle ahead.",
            AT_FAULT,
            "nuPlan: active front; RSS rule 1",
            steady(ring, 8.0),
            Car(drive=steady(cut(ring, 14.0), 3.5)),
            town="roundabout",
            end=ROUND_END,
        ),
        junction_case(
            "ego-from-the-left-of-a-vehicle",
            "At right before left, the ego does not give way to a vehicle from its right.",
            AT_FAULT,
            "Vienna Convention art. 18.4 (right before left)",
            meeting(from_left, (95.0, 121.5), 8.0, (0.0, 5.0)),
            Car(drive=meeting(town, (95.6, 120.5), 8.0, (0.0, 5.5))),
            town="old-town",
            end=OLD_TOWN_END,
        ),
        junction_case(
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
        junction_case(
            "ego-first-at-all-way-stop",
            "The ego has stopped at the all-way stop and goes; a later vehicle does not stop.",
            NOT_AT_FAULT,
            stop,
            meeting(b1_minor, (129.8, 3.2), 9.0, *_stopping(5.0, 7.0)),
            Car(drive=meeting(b1_west, (132.0, WEST), 9.0, (0.0, 8.0))),
            end=(220.0, EAST),
        ),
        junction_case(
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
    return [*_signals(), *_other_junctions()]
