"""Route files of the CARLA Leaderboard."""

from __future__ import annotations

from pathlib import Path

import pytest

from drivora_service.errors import InvalidDocument
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.importers.leaderboard import import_routes
from drivora_service.scenario.validation import validate_document

FLAT = """<routes>
  <route id="7" town="tee-town">
    <weather precipitation="20" wetness="50"/>
    <waypoint x="100.0" y="-152.1" z="0.0" pitch="0.0" yaw="180.0" roll="0.0"/>
    <waypoint x="30.0" y="-153.2" z="0.0" pitch="0.0" yaw="180.0" roll="0.0"/>
  </route>
</routes>"""

NESTED = """<?xml version="1.0" encoding="UTF-8"?>
<routes>
  <route id="0" town="tee-town">
    <weathers>
      <weather route_percentage="100" wetness="100"/>
      <weather route_percentage="0" wetness="5"/>
    </weathers>
    <waypoints>
      <position x="100.0" y="-152.1" z="371"/>
      <position x="30.0" y="-153.2" z="371"/>
    </waypoints>
    <scenarios>
      <scenario name="a" type="ParkingExit"><trigger_point x="1" y="2" z="3" yaw="90"/></scenario>
      <scenario name="b" type="ParkingExit"/>
    </scenarios>
  </route>
</routes>"""


def test_the_flat_form(networks: NetworkCatalogue) -> None:
    (imported,) = import_routes(FLAT, agent="sumo-krauss")
    assert imported.name == "tee-town_route_07"
    assert imported.notes == ()
    scenario = validate_document(imported.document, networks, ("sumo-krauss",)).scenario
    start = scenario.ego_vehicles[0].route[0]
    assert (start.x, start.y) == (100.0, 152.1)
    assert scenario.weather.precipitation == 20.0
    assert scenario.ego_vehicles[0].agent.name == "sumo-krauss"


def test_the_nested_form() -> None:
    (imported,) = import_routes(NESTED)
    assert imported.document.weather.wetness == 5.0
    assert len(imported.document.ego_vehicles[0].route) == 2
    assert any("changes 1 times" in note for note in imported.notes)
    assert any("ParkingExit (2)" in note for note in imported.notes)


def test_problems_name_the_route() -> None:
    broken = FLAT.replace('x="30.0"', 'x="west"').replace('wetness="50"', 'wetness="500"')
    with pytest.raises(InvalidDocument) as caught:
        import_routes(broken)
    assert {problem.pointer for problem in caught.value.problems} == {
        "/routes/0/ego_vehicles/0/route/1/x",
        "/routes/0/weather/wetness",
    }


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("", "not_xml"),
        ("<routes>", "not_xml"),
        ("<routes/>", "no_routes"),
        ("<route/>", "no_routes"),
        ("<a>" * 1_000_000, "too_deep"),
        ('<!DOCTYPE r [<!ENTITY a "b">]><routes/>', "not_xml"),
        ("<routes>" + "<route/>" * 3000 + "</routes>", "too_long"),
        ("<routes a='&undefined;'/>", "not_xml"),
    ],
)
def test_what_is_no_route_file(text: str, code: str) -> None:
    with pytest.raises(InvalidDocument) as caught:
        import_routes(text)
    assert [problem.code for problem in caught.value.problems] == [code]


def test_every_published_route_can_be_driven(shared_data: Path, tmp_path: Path) -> None:
    for source in sorted((shared_data / "maps").glob("*.net.xml")):
        (tmp_path / source.name).write_bytes(source.read_bytes())
    towns = NetworkCatalogue(tmp_path)
    notes: dict[str, tuple[str, ...]] = {}
    count = 0
    for file in sorted((shared_data / "routes").glob("leaderboard1_*.xml")):
        for imported in import_routes(file.read_bytes()):
            result = validate_document(imported.document, towns, ("idm",))
            count += 1
            if result.notes:
                notes[imported.name] = result.notes
    assert count == 36
    assert set(notes) == {f"Town04_route_{number}" for number in (11, 15, 32, 35, 39)}
    for number, left_out in ((11, (36, 37)), (32, (7, 8)), (35, (30,))):
        (note,) = notes[f"Town04_route_{number}"]
        assert "left out" in note
        assert all(f"{waypoint} at (" in note for waypoint in left_out)
    assert "the route ends at waypoint 35" in notes["Town04_route_11"][0]
    assert "2.4 m from the nearest lane" in notes["Town04_route_39"][0]


def test_a_town_that_is_not_there_says_how_to_import_it(
    shared_data: Path, networks: NetworkCatalogue
) -> None:
    file = shared_data / "routes" / "leaderboard2_devtest.xml"
    first, *_ = import_routes(file.read_bytes())
    with pytest.raises(InvalidDocument, match="drivora networks import FILE --name Town12"):
        validate_document(first.document, networks, ("idm",))
