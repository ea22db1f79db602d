"""SUMO networks: imported, read by the catalogue, and used by a scenario."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache

from drivora_service.errors import InvalidDocument, NetworkError
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.networks.importing.network_importing import import_network
from drivora_service.networks.projection import nearest_lane_position
from drivora_service.networks.right_of_way import right_of_way
from drivora_service.scenario.validation import validate_data
from tests.fuzzing.harness import Harness, by_name, check_refusal
from tests.fuzzing.parsers.shared import folder
from tests.networks.conftest import LOOP


@cache
def _catalogue() -> NetworkCatalogue:
    return NetworkCatalogue(folder() / "none", folder() / "imported")


def _parse(data: bytes) -> bool:
    source = folder() / "source.net.xml"
    source.write_bytes(data)
    try:
        import_network(source, "fuzzed", folder() / "imported", replace=True)
    except NetworkError as error:
        check_refusal(error)
        return False
    network = _catalogue().get("fuzzed")
    right_of_way(network)
    lane = next(lane for lane in network.lanes if lane.drivable)
    places = [lane.position_at(share * lane.arc[-1]) for share in (0.1, 0.9)]
    assert nearest_lane_position(network, places[0][0], places[0][1]) is not None
    route = [{"x": float(x), "y": float(y)} for x, y, _ in places]
    scenario = {
        "ego_vehicles": [{"id": "ego", "model": "mkz2017", "route": route}],
        "map_region": {"town": "fuzzed"},
    }
    try:
        validate_data(scenario, _catalogue(), None)
    except InvalidDocument as error:
        check_refusal(error, scenario)
    return True


def _without(pattern: str, text: str) -> str:
    return re.sub(pattern, "", text, flags=re.DOTALL)


def _seeds() -> Mapping[str, bytes]:
    plain = _without(r'  <tlLogic.*?</tlLogic>\n| tl="n1" linkIndex="."', LOOP)
    junction = '<junction id="{}" type="dead_end" incLanes="" intLanes="" x="{}" y="0"/>'
    straight = (
        '<net version="1.20"><location netOffset="0,0" convBoundary="0,0,99,9" '
        'origBoundary="0,0,99,9" projParameter="!"/>'
        '<edge id="a" from="j" to="k"><lane id="a_0" index="0" speed="9" length="99" '
        'shape="0,0 99,0"/></edge>' + junction.format("j", 0) + junction.format("k", 99) + "</net>"
    )
    two = straight.replace(
        "</net>",
        '<edge id="b" from="k" to="m"><lane id="b_0" index="0" speed="9" length="50" '
        'shape="99,0 149,0,1" allow="passenger"/></edge>'
        + junction.format("m", 149)
        + '<connection from="a" to="b" fromLane="0" toLane="0" dir="s" state="M"/></net>',
    )
    seeds = {"loop": LOOP, "without-lights": plain, "straight": straight, "two": two}
    return {name: text.encode() for name, text in seeds.items()}


NETWORK = Harness(
    name="network",
    parse=_parse,
    seeds=_seeds,
    words=(
        *('roundabout edges="a b" nodes="n0 n1"', "request", "prohibition", "param", "neigh"),
        *('type id="t" priority="1"', 'function="connector"', 'spreadType="center"', "bidi"),
        *('request index="0" response="11" foes="11" cont="0"', 'shape="0,0"', 'width="-1"'),
    ),
    max_length=8192,
)
HARNESSES = by_name(NETWORK)
