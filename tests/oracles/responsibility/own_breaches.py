"""Cases in which the ego broke a rule of its own some seconds before the contact.

It follows too near, does not give way, passes a stop sign or a red light, drives too fast, on the
wrong side or beside the road, or cuts in; in most of them it brakes too late at the end.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tests.oracles.responsibility.case import AT_FAULT, Case, Walker
from tests.oracles.responsibility.placing import after, beginning, brisk, placed
from tests.oracles.responsibility.ways import (
    Drive,
    braking,
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


def _following() -> list[Case]:
    west = lanes(ARTERIAL, "wb_hill_0")
    fast = cut(lanes(HIGHWAY, "eb_2_1"), 40.0)
    second = straight((143.0, -1.62), (250.0, -1.62))
    country = lanes(RURAL, "-valley_24_0", ":valley_limit_23_1_0", "-valley_23_0")
    left = lanes(ARTERIAL, "wb_station_1")
    return [
        placed(
            "ego-follows-at-four-metres-and-leader-slows-down",
            "The ego follows 4 m behind a vehicle at 14 m/s; the vehicle brakes, and the ego "
            "brakes 0.8 s later.",
            AT_FAULT,
            "RSS rule 1; nuPlan active front collision; Vienna 13",
            ARTERIAL,
            Drive(way=west, speeds=braking(4.8, 14.0, 7.0)),
            brisk(drive=Drive(way=cut(west, 8.7), speeds=braking(4.0, 14.0, 4.5))),
        ),
        placed(
            "ego-follows-at-five-metres-on-the-highway",
            "The ego follows 5 m behind a vehicle at 25 m/s, which brakes hard; the ego brakes "
            "0.8 s later.",
            AT_FAULT,
            "RSS rule 1; nuPlan active front collision; Vienna 13",
            HIGHWAY,
            Drive(way=fast, speeds=braking(5.8, 25.0, 7.0)),
            brisk(drive=Drive(way=cut(fast, 9.7), speeds=braking(5.0, 25.0, 7.0))),
        ),
        placed(
            "ego-follows-close-and-leader-stops-for-walker",
            "The ego follows 4 m behind a vehicle at 10 m/s, which stops for a pedestrian in the "
            "road.",
            AT_FAULT,
            "nuPlan: active front collision; RSS rule 1; Vienna art. 13",
            GRID,
            Drive(way=second, speeds=braking(5.9, 10.0, 7.0)),
            brisk(drive=Drive(way=cut(second, 8.7), speeds=braking(5.0, 10.0, 6.0))),
            Walker(points=((226.0, -4.2), (226.0, 4.2)), start_time=3.8, name="walker"),
        ),
        placed(
            "ego-follows-close-on-a-country-road",
            "The ego follows 6 m behind a truck at 20 m/s, which slows down; the ego brakes "
            "1.4 s later.",
            AT_FAULT,
            "nuPlan: active front collision; RSS rule 1; Vienna art. 13",
            RURAL,
            Drive(way=country, speeds=braking(5.4, 20.0, 6.0)),
            brisk(drive=Drive(way=cut(country, 12.4), speeds=braking(4.0, 20.0, 4.0)), model=TRUCK),
        ),
        placed(
            "ego-follows-close-and-swerves-beside-another",
            "The ego follows 4 m behind a vehicle at 15 m/s; when this brakes, the ego swerves "
            "to the right lane, into the side of a vehicle there.",
            AT_FAULT,
            "nuPlan: active lateral while leaving the lane; Vienna 13, 14; RSS rules 1 and 2",
            ARTERIAL,
            Drive(way=sway(left, 80.0, 100.0, -3.5), speeds=((0.0, 15.0), (5.4, 15.0), (7.0, 9.0))),
            brisk(drive=Drive(way=cut(left, 8.7), speeds=braking(5.0, 15.0, 5.0)), name="leader"),
            brisk(drive=meeting(lanes(ARTERIAL, "wb_station_0"), (353.0, 7.75), 5.8, (0.0, 14.0))),
        ),
    ]


def _giving_way() -> list[Case]:
    mill = lanes(ARTERIAL, "-mill_n_0", ":mill_1_0", "eb_mill_1")
    wb_left = lanes(ARTERIAL, "wb_station_1", ":mill_3_1", "wb_mill_1")
    farm = lanes(ARTERIAL, "-farm_s_0", ":farm_3_0", "eb_farm_0")
    eb_right = lanes(ARTERIAL, "eb_hill_0", ":farm_6_0", "eb_farm_0")
    eb_left = lanes(ARTERIAL, "eb_hill_1", ":farm_6_1", "eb_farm_1")
    abbey = lanes(RURAL, "-abbey_track_0", ":abbey_1_0", "-valley_24_0")
    valley = lanes(RURAL, "valley_24_0", ":abbey_3_0", "valley_25_0")
    from_mill = lanes(RURAL, "mill_0", ":mill_west_3_0", "valley_27_0")
    northwards = lanes(
        RURAL,
        "-valley_28_0",
        ":valley_limit_27_1_0",
        "-valley_27_0",
        ":mill_west_5_0",
        "-valley_26_0",
    )
    entry = lanes(
        ROUND,
        "great_south_entry_0",
        ":great_south_in_0_0",
        "great_ring_8_0",
        ":great_east_out_0_0",
        "great_east_exit_0",
    )
    ring = lanes(
        ROUND,
        *("great_west_entry_0", ":great_west_in_0_0", "great_ring_6_0", ":great_south_out_1_0"),
        *("great_ring_7_0", ":great_south_in_1_0", "great_ring_8_0", ":great_east_out_0_0"),
        "great_east_exit_0",
    )
    pocket = lanes(ARTERIAL, "wb_school_pocket_2", ":farm_2_0", "farm_s_0")
    gate = lanes(OLD_TOWN, "gate_street_1", ":gate_east_5_0", "wall_3_1")
    wall = lanes(OLD_TOWN, "-wall_3_1", ":gate_east_1_0", "-wall_2_1")
    return [
        placed(
            "ego-passes-stop-sign-and-brakes-across-the-road",
            "The ego passes a stop sign at 6 m/s to turn left, brakes in front of a vehicle on "
            "the main road, and is hit.",
            AT_FAULT,
            "Vienna 18, stop sign; RSS rule 3",
            ARTERIAL,
            meeting(mill, (228.3, 6.0), 8.0, (0.0, 6.0), (7.2, 6.0), (8.2, 0.5)),
            brisk(drive=meeting(wb_left, (231.0, 4.25), 8.0, (0.0, 16.0), (7.2, 16.0), (8.4, 9.0))),
        ),
        placed(
            "ego-turns-right-before-vehicle-and-is-hit-from-behind",
            "The ego turns right at a yield sign shortly before a vehicle at 16 m/s, which brakes "
            "and hits it from behind in its new lane.",
            AT_FAULT,
            "Vienna art. 18 (give way); RSS rule 3",
            ARTERIAL,
            meeting(farm, (974.0, -7.75), 9.0, (0.0, 5.0)),
            brisk(
                drive=meeting(eb_right, (969.5, -7.75), 9.0, (0.0, 16.0), (8.2, 16.0), (9.4, 9.0))
            ),
        ),
        placed(
            "ego-crosses-before-vehicle-on-the-country-road",
            "The ego comes out of a track and turns left in front of a vehicle at 19 m/s in "
            "plain view.",
            AT_FAULT,
            "Vienna art. 18 (give way, letter m); RSS rule 3",
            RURAL,
            meeting(abbey, beginning(RURAL, ":abbey_3_0"), 9.1, (0.0, 5.0)),
            brisk(drive=after(valley, beginning(RURAL, ":abbey_3_0"), 2.0, 8.0, (0.0, 19.0))),
        ),
        placed(
            "ego-turns-left-from-side-road-and-brakes-too-late",
            "The ego turns left out of the side road, brakes, and still meets a vehicle on the "
            "main road.",
            AT_FAULT,
            "Vienna art. 18 (give way); RSS rule 3",
            RURAL,
            meeting(from_mill, (24.6, 383.4), 9.0, (0.0, 8.0), (8.2, 8.0), (9.2, 1.5)),
            brisk(drive=meeting(northwards, (25.0, 383.0), 9.1, (0.0, 11.0))),
        ),
        placed(
            "ego-enters-great-ring-before-circulating-vehicle",
            "The ego enters the two-lane roundabout at 7 m/s before a vehicle in the outer lane, "
            "which hits its rear.",
            AT_FAULT,
            "Vienna art. 18 (give way at the roundabout entry); RSS rule 3",
            ROUND,
            after(entry, beginning(ROUND, "great_ring_8_0"), 0.0, 7.0, (0.0, 7.0)),
            brisk(drive=after(ring, beginning(ROUND, "great_ring_8_0"), -1.5, 7.0, (0.0, 9.0))),
        ),
        placed(
            "ego-turns-left-out-of-pocket-and-stops-before-oncoming",
            "The ego turns left across the oncoming lanes, brakes to a stop in the second of "
            "them, and is hit there.",
            AT_FAULT,
            "Vienna 16, 18; RSS rule 3",
            ARTERIAL,
            meeting(pocket, (958.6, -6.8), 8.0, (0.0, 6.0), (6.9, 6.0), (7.9, 0.0)),
            brisk(
                drive=meeting(eb_right, (957.0, -7.75), 8.1, (0.0, 16.0), (7.4, 16.0), (8.5, 8.0))
            ),
        ),
        placed(
            "ego-passes-stop-sign-at-the-town-gate",
            "The ego turns left past a stop sign without stopping, and a vehicle on the ring "
            "road hits its left side.",
            AT_FAULT,
            "Vienna art. 18 (stop sign); RSS rule 3",
            OLD_TOWN,
            meeting(gate, (261.5, 9.0), 8.0, (0.0, 5.0)),
            brisk(drive=meeting(wall, (263.0, 11.0), 8.0, (0.0, 10.0))),
        ),
        placed(
            "ego-turns-out-before-two-vehicles-in-line",
            "The ego turns right at a yield sign into a gap between two vehicles; the first "
            "has passed, the second, at 15 m/s, hits it from behind.",
            AT_FAULT,
            "Vienna 18 (give way); RSS rule 3",
            ARTERIAL,
            meeting(farm, (971.0, -7.75), 9.0, (0.0, 4.0)),
            brisk(drive=meeting(eb_right, (1016.0, -7.75), 9.0, (0.0, 15.0)), name="first"),
            brisk(drive=meeting(eb_right, (966.5, -7.75), 9.0, (0.0, 15.0))),
            brisk(drive=meeting(eb_left, (990.0, -4.25), 9.0, (0.0, 15.0)), name="beside"),
        ),
    ]


def cases() -> list[Case]:
    """All of this kind."""
    return [*_following(), *_giving_way()]
