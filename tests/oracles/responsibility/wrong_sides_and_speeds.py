"""Cases in which the ego drives too fast, on red, on the wrong side, beside the road, or cuts in.

The breach leads to the danger; at the end most of the egos brake, too late.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tests.oracles.responsibility.case import AT_FAULT, UNDETERMINED, Case, Walker
from tests.oracles.responsibility.placing import after, arc_of, beginning, beside, brisk, placed
from tests.oracles.responsibility.ways import (
    Drive,
    cut,
    lanes,
    meeting,
    straight,
    sway,
)

ARTERIAL, GRID, HIGHWAY = "arterial", "signal-grid", "highway"
OLD_TOWN, ROUND, RURAL, TEE = "old-town", "roundabout", "rural", "tee-town"
TRUCK = "vehicle.carlamotors.european_hgv"

SIDE_GREEN: Mapping[str, Any] = {"junctions": {"hill": {"offset": -46.0}}}
"""At hill, green for the road from north to south from 0 to 26 s."""


def _too_fast() -> list[Case]:
    harbour = lanes(TEE, "-harbour_1_0", ":harbour_mill_3_0", "-harbour_0_0")
    emerging = lanes(TEE, "-mill_1_0", ":harbour_mill_1_0", "harbour_1_0")
    alley = lanes(OLD_TOWN, "castle_lane_1")
    bend = lanes(
        RURAL, "valley_25_0", ":valley_limit_25_1_0", "valley_26_0", ":mill_west_0_0", "valley_27_0"
    )
    against = lanes(RURAL, "-valley_27_0", ":mill_west_5_0", "-valley_26_0")
    out = arc_of(bend, beginning(RURAL, "valley_26_0"))
    third = cut(lanes(HIGHWAY, "eb_4_2"), 10.0)
    second = lanes(HIGHWAY, "eb_4_1")
    return [
        placed(
            "ego-at-eighty-six-in-town-and-vehicle-emerges",
            "The ego drives at 24 m/s where 13.9 are allowed; a vehicle comes out of a side road "
            "40 m ahead, and the ego brakes and hits it.",
            UNDETERMINED,
            "Vienna art. 18 (other failed to give way) against art. 13 (ego's speed)",
            TEE,
            meeting(harbour, (134.0, 3.6), 5.2, (0.0, 24.0), (4.2, 24.0), (5.4, 15.5)),
            brisk(drive=meeting(emerging, (131.0, 4.2), 5.3, (0.0, 4.0))),
        ),
        placed(
            "ego-too-fast-in-alley-and-walker-crosses",
            "The ego drives at 13 m/s in an alley where 5.6 are allowed; a pedestrian crosses "
            "25 m ahead, and the ego brakes and hits it.",
            AT_FAULT,
            "Vienna art. 13 and 21; nuPlan: active front collision",
            OLD_TOWN,
            meeting(
                alley,
                beside(OLD_TOWN, "castle_lane_1", 78.0, 0.0),
                6.2,
                (0.0, 13.0),
                (5.2, 13.0),
                (6.7, 3.0),
            ),
            Walker(
                points=(
                    beside(OLD_TOWN, "castle_lane_1", 81.0, -2.6),
                    beside(OLD_TOWN, "castle_lane_1", 81.0, 2.6),
                ),
                start_time=4.2,
            ),
        ),
        placed(
            "ego-too-fast-in-bend-drifts-over-to-oncoming",
            "The ego drives at 19 m/s where 11.1 are allowed, drifts over the line in the bend "
            "and meets an oncoming vehicle.",
            AT_FAULT,
            "RSS rule 1 opposite directions; Vienna 10, 12, 13; nuPlan active lateral",
            RURAL,
            after(
                sway(bend, out + 2.0, out + 34.0, 2.4),
                beginning(RURAL, "valley_26_0"),
                22.0,
                7.0,
                (0.0, 19.0),
            ),
            brisk(drive=after(against, (4.0, 425.0), -6.0, 7.0, (0.0, 10.0))),
        ),
        placed(
            "ego-at-one-hundred-sixty-and-vehicle-changes-lanes",
            "The ego drives at 44 m/s where 33.3 are allowed; a vehicle at 28 m/s changes into "
            "its lane 40 m ahead, and the ego brakes too late.",
            AT_FAULT,
            "UNECE R157 annex 3 (competent driver would have stayed behind); RSS rule 1; "
            "Vienna art. 13",
            HIGHWAY,
            Drive(way=third, speeds=((0.0, 44.0), (5.2, 44.0), (7.6, 30.0))),
            brisk(
                drive=Drive(way=sway(cut(second, 118.0), 76.0, 150.0, 3.75), speeds=((0.0, 28.0),))
            ),
        ),
    ]


def _signals() -> list[Case]:
    rose = lanes(
        ARTERIAL, "eb_rose_1", ":eb_hill_pocket_0_1", "eb_rose_pocket_1", ":hill_11_1", "eb_hill_1"
    )
    down = lanes(ARTERIAL, "-hill_n_0", ":hill_1_0", "hill_s_0")
    right = lanes(ARTERIAL, "-school_s_0", ":school_7_0", "eb_school_0")
    through = lanes(
        ARTERIAL,
        *("eb_farm_0", ":eb_school_pocket_0_0", "eb_farm_pocket_0", ":school_11_0", "eb_school_0"),
    )
    return [
        placed(
            "ego-passes-red-and-brakes-in-the-junction",
            "The ego passes a red light at 14 m/s, brakes in the junction and meets a vehicle "
            "on green.",
            AT_FAULT,
            "Vienna 23; nuPlan active front collision",
            ARTERIAL,
            meeting(rose, (774.0, -4.25), 8.0, (0.0, 14.0), (7.5, 14.0), (8.8, 5.0)),
            brisk(drive=meeting(down, (778.25, -1.0), 8.0, (0.0, 10.0))),
            lights=SIDE_GREEN,
        ),
        placed(
            "ego-turns-right-on-red-and-is-hit-from-behind",
            "The ego turns right on red in front of a vehicle on green, which brakes and hits it "
            "from behind.",
            AT_FAULT,
            "Vienna 23 (red); RSS rule 3",
            ARTERIAL,
            meeting(right, (1146.0, -7.75), 8.0, (0.0, 5.0)),
            brisk(
                drive=meeting(through, (1141.5, -7.75), 8.0, (0.0, 15.0), (7.3, 15.0), (8.5, 8.0))
            ),
        ),
    ]


def _sides_and_verges() -> list[Case]:
    onward = lanes(RURAL, "valley_8_0")
    back = lanes(RURAL, "-valley_8_0")
    ridge = lanes(RURAL, "ridge_1_0")
    country = lanes(RURAL, "mill_0")
    queen = straight((143.0, 218.38), (250.0, 218.38))
    basic = lanes(HIGHWAY, "wb_2_1")
    slow = lanes(HIGHWAY, "wb_2_0")
    outer = lanes(HIGHWAY, "eb_b_decelerate_3")
    middle = lanes(HIGHWAY, "eb_b_decelerate_1")
    return [
        placed(
            "ego-on-wrong-side-goes-back-too-late",
            "The ego overtakes on the wrong side and goes back when an oncoming vehicle is near; "
            "both brake and their left front corners meet.",
            AT_FAULT,
            "RSS rule 1 for opposite directions; Vienna art. 10, 11 and 12",
            RURAL,
            Drive(
                way=sway(sway(onward, 20.0, 50.0, 3.5), 100.0, 120.0, -3.5),
                speeds=((0.0, 16.0), (6.2, 16.0), (7.6, 7.0)),
            ),
            brisk(
                drive=meeting(onward, beside(RURAL, "valley_8_0", 95.0, 0.0), 7.0, (0.0, 10.0)),
                name="slow",
            ),
            brisk(
                drive=meeting(
                    back,
                    beside(RURAL, "valley_8_0", 113.0, 3.5),
                    7.0,
                    (0.0, 17.0),
                    (6.3, 17.0),
                    (7.7, 8.0),
                )
            ),
        ),
        placed(
            "ego-overtakes-comes-back-short-and-brakes",
            "The ego overtakes at 18 m/s, comes back 2 m ahead of the other vehicle and brakes; "
            "the other hits it from behind.",
            AT_FAULT,
            "RSS rule 2 (reckless cut-in); Vienna art. 11, 14 and 17",
            RURAL,
            Drive(
                way=sway(sway(ridge, 10.0, 40.0, 3.4), 92.0, 122.0, -3.4),
                speeds=((0.0, 18.0), (6.2, 18.0), (7.4, 9.0)),
            ),
            brisk(drive=meeting(ridge, beside(RURAL, "ridge_1_0", 109.0, 0.0), 6.7, (0.0, 13.0))),
        ),
        placed(
            "ego-passes-over-the-verge-and-comes-back",
            "The ego passes a slower vehicle over the verge to its right and touches it as it "
            "comes back to the road.",
            AT_FAULT,
            "Vienna art. 10 and 11 (passing over the verge on the wrong side); nuPlan: active "
            "lateral outside the lane",
            RURAL,
            Drive(
                way=sway(sway(country, 20.0, 45.0, -3.6), 88.0, 112.0, 3.6), speeds=((0.0, 13.0),)
            ),
            brisk(drive=meeting(country, beside(RURAL, "mill_0", 98.0, 0.0), 7.7, (0.0, 9.0))),
        ),
        placed(
            "ego-over-the-sidewalk-and-back-before-another",
            "The ego leaves the lane over the sidewalk, comes back a few metres ahead of the "
            "vehicle that it has passed, brakes, and is hit.",
            UNDETERMINED,
            "RSS rule 2 and Vienna art. 11, 14 against the ego; UNECE R157 annex 3 and RSS "
            "rule 1 against the one behind",
            GRID,
            Drive(
                way=sway(sway(queen, 8.0, 26.0, -3.0), 50.0, 64.0, 3.0),
                speeds=((0.0, 11.0), (5.4, 11.0), (6.9, 2.5)),
            ),
            brisk(drive=meeting(queen, (143.0 + 50.5, 218.38), 5.4, (0.0, 6.0))),
        ),
        placed(
            "ego-cuts-in-on-the-highway-and-brakes",
            "The ego at 28 m/s changes in 3 m ahead of a vehicle at 28 m/s and brakes a second "
            "later.",
            AT_FAULT,
            "RSS rule 2; UNECE R157 annex 3; Vienna art. 11, 14",
            HIGHWAY,
            Drive(
                way=sway(cut(basic, 20.0), 80.0, 130.0, -3.75),
                speeds=((0.0, 28.0), (5.2, 28.0), (8.2, 13.0)),
            ),
            brisk(drive=Drive(way=cut(slow, 12.3), speeds=((0.0, 28.0), (6.2, 28.0), (8.2, 16.0)))),
        ),
        placed(
            "ego-crosses-two-lanes-to-the-exit-and-brakes",
            "The ego crosses two lanes towards the exit, brakes in front of a vehicle at 26 m/s "
            "and is hit from behind.",
            AT_FAULT,
            "RSS rule 2 (reckless cut-in); Vienna art. 14 and 17 (no needless braking)",
            HIGHWAY,
            Drive(
                way=cut(sway(outer, 60.0, 125.0, -7.5), 12.0),
                speeds=((0.0, 27.0), (4.0, 27.0), (7.0, 15.0)),
            ),
            brisk(
                drive=Drive(way=cut(middle, 0.1), speeds=((0.0, 26.0), (6.0, 26.0), (7.0, 22.0)))
            ),
            to=lanes(HIGHWAY, "eb_b_decelerate_1")[-1].tolist(),
        ),
    ]


def cases() -> list[Case]:
    """All of this kind."""
    return [*_too_fast(), *_signals(), *_sides_and_verges()]
