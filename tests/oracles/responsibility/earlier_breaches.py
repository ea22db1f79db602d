"""Cases in which the ego breaks no rule, or did so some time before and elsewhere."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tests.oracles.responsibility.case import NOT_AT_FAULT, Case
from tests.oracles.responsibility.placing import beside, brisk, placed
from tests.oracles.responsibility.ways import Drive, cut, lanes, meeting, sway

ARTERIAL, RURAL, TEE = "arterial", "rural", "tee-town"

SIDE_GREEN: Mapping[str, Any] = {"junctions": {"station": {"offset": -46.0}}}
"""At station, green for the road from north to south from 0 to 26 s."""


def _earlier() -> list[Case]:
    west = lanes(ARTERIAL, "wb_mill_0")
    mill = cut(lanes(ARTERIAL, "-mill_n_0", ":mill_0_0", "wb_mill_0"), 130.0)
    main = lanes(ARTERIAL, "wb_station_0", ":mill_3_0", "wb_mill_0")
    hill = lanes(ARTERIAL, "wb_hill_1", ":wb_station_pocket_0_1", "wb_hill_pocket_1")
    country = lanes(RURAL, "-valley_25_0")
    return [
        placed(
            "ego-drove-too-fast-seven-seconds-ago-and-is-hit",
            "The ego drives at 22 m/s where 16.7 are allowed, slows to 10 m/s by 4.5 s, and is "
            "hit from behind by a vehicle at 16 m/s 6 s later.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1",
            ARTERIAL,
            Drive(way=west, speeds=((0.0, 22.0), (2.0, 22.0), (4.5, 10.0))),
            brisk(drive=meeting(west, (64.8, 7.75), 11.5, (0.0, 16.0))),
            seconds=14.0,
        ),
        placed(
            "ego-passed-stop-sign-eight-seconds-ago-and-is-hit",
            "The ego passes a stop sign without stopping, with the main road empty; 8 s later a "
            "vehicle runs into it from behind on the main road.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1; UNECE R157 annex 3",
            ARTERIAL,
            Drive(way=mill, speeds=((0.0, 6.0), (5.0, 6.0), (8.0, 12.0))),
            brisk(drive=meeting(main, (147.7, 7.75), 12.4, (0.0, 17.0))),
            seconds=15.0,
        ),
        placed(
            "ego-overtook-on-wrong-side-eight-seconds-ago-and-is-hit",
            "The ego overtakes on the wrong side and goes back far ahead; 8 s later a third "
            "vehicle runs into it from behind.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1",
            RURAL,
            Drive(
                way=sway(sway(country, 8.0, 32.0, 3.5), 70.0, 94.0, -3.5),
                speeds=((0.0, 18.0), (6.0, 18.0), (8.0, 13.0)),
            ),
            brisk(
                drive=meeting(country, beside(RURAL, "-valley_25_0", 48.0, 0.0), 3.0, (0.0, 9.0)),
                name="slow",
            ),
            brisk(
                drive=meeting(
                    sway(sway(country, 60.0, 90.0, 3.5), 130.0, 160.0, -3.5),
                    beside(RURAL, "-valley_25_0", 178.0, 0.0),
                    11.9,
                    (0.0, 20.0),
                ),
            ),
            seconds=15.0,
        ),
        placed(
            "ego-had-followed-close-and-has-dropped-back",
            "The ego follows 4 m behind a vehicle, drops back to 16 m and follows there for 3 s; "
            "both stop gently and a third vehicle hits the ego from behind.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1",
            ARTERIAL,
            Drive(
                way=hill,
                speeds=(
                    (0.0, 14.0),
                    (1.5, 14.0),
                    (3.5, 4.0),
                    (5.5, 4.0),
                    (7.0, 7.0),
                    (9.0, 7.0),
                    (11.0, 0.0),
                ),
            ),
            brisk(
                drive=Drive(
                    way=cut(hill, 8.7),
                    speeds=((0.0, 14.0), (1.5, 14.0), (4.0, 7.0), (8.5, 7.0), (11.0, 0.0)),
                ),
                name="leader",
            ),
            brisk(drive=meeting(hill, (698.8, 4.25), 10.5, (0.0, 13.0))),
            seconds=14.0,
        ),
    ]


def _none() -> list[Case]:
    through = lanes(ARTERIAL, "-station_n_0", ":station_1_0", "station_s_0")
    along = lanes(
        ARTERIAL,
        "eb_mill_1",
        ":eb_station_pocket_0_1",
        "eb_mill_pocket_1",
        ":station_11_1",
        "eb_station_1",
    )
    east = lanes(TEE, "east_1_0")
    against = lanes(TEE, "-east_1_0")
    rose = lanes(ARTERIAL, "-rose_s_0", ":rose_0_0", "eb_rose_0")
    station = lanes(ARTERIAL, "eb_station_0", ":rose_2_0", "eb_rose_0")
    return [
        placed(
            "vehicle-passes-red-and-ego-brakes-at-once",
            "The ego crosses on green; a vehicle passes its red light from the right, the ego "
            "brakes hard and hits it.",
            NOT_AT_FAULT,
            "Vienna art. 23; RSS rule 3",
            ARTERIAL,
            meeting(through, (448.25, -0.5), 8.0, (0.0, 12.0), (7.3, 12.0), (8.4, 4.0)),
            brisk(drive=meeting(along, (447.0, -4.25), 8.0, (0.0, 15.0))),
            lights=SIDE_GREEN,
        ),
        placed(
            "vehicle-turns-out-of-side-road-and-ego-brakes-at-once",
            "The ego drives at the limit on the main road; a vehicle turns out of a side road "
            "25 m ahead, the ego brakes hard and hits its rear.",
            NOT_AT_FAULT,
            "Vienna 18 (other gives way); RSS rule 3; R157: not avoidable",
            ARTERIAL,
            meeting(station, (621.0, -7.75), 8.0, (0.0, 16.0), (7.0, 16.0), (8.6, 4.0)),
            brisk(drive=meeting(rose, (626.5, -8.0), 8.0, (0.0, 5.0))),
        ),
        placed(
            "ego-slightly-too-fast-and-oncoming-comes-over",
            "The ego drives at 14.5 m/s where 13.9 are allowed; an oncoming vehicle comes over "
            "the line in the last second and meets it.",
            NOT_AT_FAULT,
            "RSS rule 1 for opposite directions (correct lane not to blame); Vienna art. 10, 12",
            TEE,
            meeting(east, beside(TEE, "east_1_0", 90.0, 0.0), 5.5, (0.0, 14.5)),
            brisk(
                drive=meeting(
                    sway(against, 20.0, 40.0, 3.2),
                    beside(TEE, "east_1_0", 94.0, 2.0),
                    5.5,
                    (0.0, 13.0),
                )
            ),
        ),
    ]


def cases() -> list[Case]:
    """All of this kind."""
    return [*_earlier(), *_none()]
