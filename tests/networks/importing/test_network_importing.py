import hashlib
import sys
from pathlib import Path

import numpy as np
import pytest
from shapely import LineString, STRtree, points

from drivora_service.errors import NetworkError
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.networks.importing.network_importing import import_network
from drivora_service.networks.network_loading import load_network
from drivora_service.networks.provenance import read_provenance
from drivora_service.networks.road_network import RoadNetwork

TOWNS = ("Town01", "Town02", "Town04")

# Two streets that cross at a signal, one with sidewalks, a footway and a dead end.
OSM = """<?xml version="1.0" encoding="UTF-8"?>
<osm version="0.6" generator="by hand">
  <bounds minlat="48.0000" minlon="11.0000" maxlat="48.0030" maxlon="11.0040"/>
  <node id="1" lat="48.0010" lon="11.0000" version="1" visible="true"/>
  <node id="2" lat="48.0010" lon="11.0020" version="1" visible="true">
    <tag k="highway" v="traffic_signals"/>
  </node>
  <node id="3" lat="48.0010" lon="11.0040" version="1" visible="true"/>
  <node id="4" lat="48.0000" lon="11.0020" version="1" visible="true"/>
  <node id="5" lat="48.0015" lon="11.0020" version="1" visible="true"/>
  <node id="6" lat="48.0030" lon="11.0020" version="1" visible="true"/>
  <node id="7" lat="48.0030" lon="11.0000" version="1" visible="true"/>
  <way id="10" version="1" visible="true">
    <nd ref="1"/><nd ref="2"/><nd ref="3"/>
    <tag k="highway" v="primary"/><tag k="name" v="Long Street"/>
    <tag k="lanes" v="4"/><tag k="maxspeed" v="50"/>
  </way>
  <way id="11" version="1" visible="true">
    <nd ref="4"/><nd ref="2"/><nd ref="5"/><nd ref="6"/>
    <tag k="highway" v="residential"/><tag k="name" v="Short Street"/>
    <tag k="sidewalk" v="both"/><tag k="maxspeed" v="30"/>
  </way>
  <way id="12" version="1" visible="true">
    <nd ref="6"/><nd ref="7"/>
    <tag k="highway" v="footway"/>
  </way>
</osm>
"""


def imported(path: Path) -> RoadNetwork:
    return load_network(path, path.parent.name)


def drivable_ids(network: RoadNetwork) -> set[str]:
    return {lane.id for lane in network.lanes if lane.drivable and not lane.is_internal}


@pytest.mark.parametrize("town", TOWNS)
def test_a_sumo_network_is_copied(shared_data: Path, tmp_path: Path, town: str) -> None:
    source = shared_data / "maps" / f"{town}.net.xml"
    path = import_network(source, town, tmp_path)
    assert path == tmp_path / town / f"{town}.net.xml"
    assert path.read_bytes() == source.read_bytes()
    provenance = read_provenance(tmp_path / town)
    assert provenance.source == source.name
    assert provenance.source_sha256 == hashlib.sha256(source.read_bytes()).hexdigest()
    assert provenance.netconvert is None
    assert sorted(p.name for p in tmp_path.rglob("*")) == sorted(
        [town, f"{town}.net.xml", "provenance.yaml"]
    )


@pytest.mark.parametrize("town", TOWNS)
def test_an_opendrive_town_becomes_the_known_network(
    shared_data: Path, tmp_path: Path, town: str
) -> None:
    network = imported(import_network(shared_data / "maps" / f"{town}.xodr", town, tmp_path))
    known = load_network(shared_data / "maps" / f"{town}.net.xml", town)

    assert network.net_offset == known.net_offset
    assert drivable_ids(network) == drivable_ids(known)
    assert network.programs.keys() == known.programs.keys()
    lines = STRtree([LineString(lane.shape) for lane in known.lanes if lane.drivable])
    places = np.concatenate(
        [lane.shape for lane in network.lanes if lane.drivable and not lane.is_internal]
    )
    _, distances = lines.query_nearest(points(places), return_distance=True, all_matches=False)
    assert distances.max() < 0.5

    provenance = read_provenance(tmp_path / town)
    assert provenance.netconvert
    assert "--opendrive.curve-resolution" in provenance.options


def test_an_import_is_the_same_every_time(shared_data: Path, tmp_path: Path) -> None:
    source = shared_data / "maps" / "Town02.xodr"
    first = import_network(source, "town", tmp_path / "a")
    second = import_network(source, "town", tmp_path / "b")
    assert first.read_bytes() == second.read_bytes()
    assert str(tmp_path).encode() not in first.read_bytes()
    for path in (first, second):
        assert str(tmp_path) not in (path.parent / "provenance.yaml").read_text(encoding="utf-8")


@pytest.mark.parametrize("file_name", ["quarter.osm", "quarter.osm.xml", "QUARTER.OSM"])
def test_openstreetmap(tmp_path: Path, file_name: str) -> None:
    source = tmp_path / file_name
    source.write_text(OSM, encoding="utf-8")
    network = imported(import_network(source, "quarter", tmp_path / "networks"))

    assert len(network.programs) == 1
    roads = [lane for lane in network.lanes if lane.drivable and not lane.is_internal]
    assert {round(lane.speed_limit * 3.6) for lane in roads} == {30, 50}
    # Two arms of two lanes each way, and two arms of one: the footway is gone.
    assert len(roads) == 2 * 4 + 2 * 2
    footpaths = [lane for lane in network.lanes if lane.walkable and not lane.drivable]
    sidewalks = [lane for lane in footpaths if not lane.is_internal]
    assert len(sidewalks) == 4
    assert {lane.edge_id.strip("-").partition("#")[0] for lane in sidewalks} == {"11"}
    assert len(footpaths) > len(sidewalks), "crossings and walking areas join the sidewalks"
    width = network.bounds[2] - network.bounds[0]
    assert width == pytest.approx(0.004 * 111_320 * np.cos(np.radians(48.0)), rel=0.01)
    assert "OpenStreetMap" in read_provenance(tmp_path / "networks" / "quarter").licence


def test_a_taken_name_is_refused_unless_it_is_to_be_replaced(
    repository: Path, tmp_path: Path
) -> None:
    first = repository / "sumo_nets" / "tee-town" / "tee-town.net.xml"
    second = repository / "sumo_nets" / "rural" / "rural.net.xml"
    path = import_network(first, "place", tmp_path)
    with pytest.raises(NetworkError, match="already imported"):
        import_network(second, "place", tmp_path)
    assert path.read_bytes() == first.read_bytes()
    assert import_network(second, "place", tmp_path, replace=True) == path
    assert path.read_bytes() == second.read_bytes()
    assert [p.name for p in tmp_path.iterdir()] == ["place"]


def test_the_name_of_a_shipped_network_is_taken(repository: Path, tmp_path: Path) -> None:
    source = repository / "sumo_nets" / "rural" / "rural.net.xml"
    with pytest.raises(NetworkError, match="'tee-town' comes with Drivora"):
        import_network(source, "tee-town", tmp_path, replace=True)


def test_what_is_left_of_an_interrupted_import_is_no_network(
    repository: Path, tmp_path: Path
) -> None:
    source = repository / "sumo_nets" / "rural" / "rural.net.xml"
    left = tmp_path / ".importing-abc"
    left.mkdir()
    (left / ".importing-abc.net.xml").write_bytes(source.read_bytes())
    import_network(source, "place", tmp_path)
    assert NetworkCatalogue(tmp_path / "none", tmp_path).names() == ("place",)


def test_a_failed_replacement_leaves_the_network_alone(repository: Path, tmp_path: Path) -> None:
    source = repository / "sumo_nets" / "tee-town" / "tee-town.net.xml"
    path = import_network(source, "place", tmp_path / "networks")
    broken = tmp_path / "broken.net.xml"
    broken.write_text("<net><edge/></net>", encoding="utf-8")
    with pytest.raises(NetworkError):
        import_network(broken, "place", tmp_path / "networks", replace=True)
    assert path.read_bytes() == source.read_bytes()
    assert [p.name for p in (tmp_path / "networks").iterdir()] == ["place"]


@pytest.mark.parametrize("name", ["", "../x", "a/b", "a.b", ".", "ä", "a b", "x" * 65, "a\n"])
def test_names_that_are_not_allowed(repository: Path, tmp_path: Path, name: str) -> None:
    source = repository / "sumo_nets" / "tee-town" / "tee-town.net.xml"
    with pytest.raises(NetworkError, match="cannot name a network"):
        import_network(source, name, tmp_path / "networks")
    assert not (tmp_path / "networks").exists()


FOOTWAY_ONLY = OSM.replace('v="primary"', 'v="footway"').replace('v="residential"', 'v="footway"')
ENTITY = '<!DOCTYPE osm [<!ENTITY x SYSTEM "file:///etc/passwd">]>\n<osm version="0.6">&x;</osm>'
BOMB = (
    '<!DOCTYPE net [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]><net>&b;</net>'
)


@pytest.mark.parametrize(
    ("file_name", "content", "says"),
    [
        ("town.json", "{}", r"allowed are \.net\.xml, \.xodr, \.osm"),
        ("town.xml", "<net/>", r"allowed are \.net\.xml"),
        ("town.net.xml", "no XML", "not well-formed XML"),
        ("town.net.xml", "", "not well-formed XML"),
        ("town.net.xml", "<net><edge></net>", "not well-formed XML"),
        ("town.net.xml", "<osm/>", "root element is <osm>, not <net>"),
        ("town.net.xml", "<net/>", "network 'town'"),
        ("town.net.xml", BOMB, "document type"),
        (
            "town.xodr",
            "<OpenDRIVE/>",
            "cannot import 'town.xodr': netconvert failed: No nodes loaded",
        ),
        (
            "town.xodr",
            "<OpenDRIVE><road id='1' length='x'/></OpenDRIVE>",
            "'junction' is missing .*; ",
        ),
        ("town.osm", FOOTWAY_ONLY, "'town.osm': .*no road that is open to cars"),
        ("town.osm", '<osm version="0.6"/>', "no road that is open to cars"),
        ("town.osm", ENTITY, "document type"),
    ],
)
def test_files_that_cannot_be_used_leave_nothing_behind(
    tmp_path: Path, file_name: str, content: str, says: str
) -> None:
    source = tmp_path / file_name
    source.write_text(content, encoding="utf-8")
    with pytest.raises(NetworkError, match=says):
        import_network(source, "town", tmp_path / "networks")
    assert list((tmp_path / "networks").glob("*")) == []


def test_a_file_that_is_too_large(tmp_path: Path) -> None:
    source = tmp_path / "town.net.xml"
    source.write_text("<net>" + " " * 5000 + "</net>", encoding="utf-8")
    with pytest.raises(NetworkError, match="too large"):
        import_network(source, "town", tmp_path / "networks", max_bytes=5000)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(NetworkError, match=r"cannot read 'town\.xodr': No such file"):
        import_network(tmp_path / "town.xodr", "town", tmp_path / "networks")


def test_only_conversions_need_netconvert(
    repository: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # None in sys.modules is how Python marks a package that cannot be imported.
    monkeypatch.setitem(sys.modules, "sumo", None)
    osm = tmp_path / "quarter.osm"
    osm.write_text(OSM, encoding="utf-8")
    with pytest.raises(NetworkError, match=r"pip install '\.\[networks\]'"):
        import_network(osm, "quarter", tmp_path / "networks")
    source = repository / "sumo_nets" / "tee-town" / "tee-town.net.xml"
    import_network(source, "town", tmp_path / "networks")
    assert [p.name for p in (tmp_path / "networks").iterdir()] == ["town"]
