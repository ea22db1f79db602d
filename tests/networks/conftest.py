"""Networks that the tests of this room share."""

from __future__ import annotations

from pathlib import Path

import pytest

from drivora_service.networks.network_loading import load_network
from drivora_service.networks.road_network import RoadNetwork

LOOP = """<?xml version="1.0" encoding="UTF-8"?>
<net version="1.20">
  <location netOffset="5.00,-7.50" convBoundary="-20.00,0.00,260.00,60.00"
            origBoundary="0,0,0,0" projParameter="!"/>
  <edge id=":n1_0" function="internal">
    <lane id=":n1_0_0" index="0" speed="10.00" length="10.00" shape="100.00,0.00 110.00,0.00"/>
  </edge>
  <edge id=":n1_1" function="internal">
    <lane id=":n1_1_0" index="0" speed="10.00" length="5.00" shape="100.00,3.20 105.00,3.20"/>
  </edge>
  <edge id=":n1_2" function="internal">
    <lane id=":n1_2_0" index="0" speed="10.00" length="5.00" shape="105.00,3.20 110.00,3.20"/>
  </edge>
  <edge id=":n2_0" function="internal">
    <lane id=":n2_0_0" index="0" speed="10.00" length="0.10" shape="200.00,0.00 200.00,0.00"/>
  </edge>
  <edge id=":n1_c0" function="crossing" crossingEdges="a">
    <lane id=":n1_c0_0" index="0" allow="pedestrian" speed="2.78" length="8.40" width="4.00"
          shape="97.00,-3.00 97.00,5.40"/>
  </edge>
  <edge id=":n1_w0" function="walkingarea">
    <lane id=":n1_w0_0" index="0" allow="pedestrian" speed="2.78" length="3.00" width="2.00"
          shape="95.00,-4.00 99.00,-4.00 99.00,-2.00 95.00,-2.00"/>
  </edge>
  <edge id="a" from="n0" to="n1" priority="1">
    <lane id="a_0" index="0" allow="pedestrian" speed="13.89" length="95.00" width="2.00"
          shape="0.00,-2.60 95.00,-2.60"/>
    <lane id="a_1" index="1" disallow="pedestrian tram" speed="15.00" length="100.00"
          shape="0.00,0.00 100.00,0.00"/>
    <lane id="a_2" index="2" disallow="pedestrian tram" speed="15.00" length="100.00"
          shape="0.00,3.20 100.00,3.20"/>
  </edge>
  <edge id="b" from="n1" to="n2" priority="1">
    <lane id="b_0" index="0" speed="12.00" length="90.00" width="3.00"
          shape="110.00,0.00 200.00,0.00"/>
    <lane id="b_1" index="1" speed="12.00" length="90.00" width="3.00"
          shape="110.00,3.20 200.00,3.20"/>
  </edge>
  <edge id="c" from="n2" to="n3" priority="1">
    <lane id="c_0" index="0" speed="12.00" length="60.00" shape="200.00,0.00 260.00,0.00"/>
  </edge>
  <edge id="d" from="n3" to="n0" priority="1">
    <lane id="d_0" index="0" speed="8.00" length="420.00"
          shape="260.00,0.00 260.00,60.00 -20.00,60.00 -20.00,0.00 0.00,0.00"/>
  </edge>
  <edge id="e" from="n2" to="n4" priority="1">
    <lane id="e_0" index="0" speed="12.00" length="50.00" shape="200.00,-40.00 250.00,-40.00"/>
  </edge>
  <tlLogic id="n1" type="static" programID="0" offset="0">
    <phase duration="1" state="rr"/>
  </tlLogic>
  <tlLogic id="n1" type="static" programID="evening" offset="4">
    <phase duration="30" state="Gr"/>
    <phase duration="3" state="yr"/>
    <phase duration="20.5" state="rG"/>
  </tlLogic>
  <junction id="n0" type="priority" x="0.00" y="0.00" incLanes="d_0" intLanes=""
            shape="0.00,1.60 0.00,-1.60"/>
  <junction id="n1" type="traffic_light" x="105.00" y="0.00" incLanes="a_1 a_2"
            intLanes=":n1_0_0 :n1_1_0" shape="100.00,4.80 110.00,4.80 110.00,-1.60 100.00,-1.60"/>
  <junction id="n2" type="priority" x="200.00" y="0.00" incLanes="b_0 b_1" intLanes=":n2_0_0"
            shape="200.00,4.80 200.00,-1.60 200.00,4.80"/>
  <junction id="n3" type="priority" x="260.00" y="0.00" incLanes="c_0" intLanes=""/>
  <junction id="n4" type="dead_end" x="250.00" y="-40.00" incLanes="e_0" intLanes=""
            shape="250.00,-38.40 250.00,-41.60"/>
  <connection from="a" to="b" fromLane="1" toLane="0" via=":n1_0_0" tl="n1" linkIndex="0" dir="s"
              state="O"/>
  <connection from="a" to="b" fromLane="2" toLane="1" via=":n1_1_0" tl="n1" linkIndex="1" dir="s"
              state="o"/>
  <connection from="b" to="c" fromLane="0" toLane="0" via=":n2_0_0" dir="s" state="M"/>
  <connection from="c" to="d" fromLane="0" toLane="0" dir="l" state="M"/>
  <connection from="d" to="a" fromLane="0" toLane="1" dir="s" state="M"/>
  <connection from=":n1_0" to="b" fromLane="0" toLane="0" dir="s" state="M"/>
  <connection from=":n1_1" to="b" fromLane="0" toLane="1" via=":n1_2_0" dir="s" state="m"/>
  <connection from=":n1_2" to="b" fromLane="0" toLane="1" dir="s" state="M"/>
  <connection from=":n2_0" to="c" fromLane="0" toLane="0" dir="s" state="M"/>
</net>
"""
"""A loop: a (a sidewalk and two lanes) → signal n1 → b (two lanes, the left one ends) → c → d → a.

The left way through n1 is two internal lanes; n2's internal lane is a single place; e is cut off.
"""

TOWNS = ("Town01", "Town02", "Town04")


@pytest.fixture(scope="session")
def loop_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("networks") / "loop.net.xml"
    path.write_text(LOOP, encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def loop(loop_file: Path) -> RoadNetwork:
    return load_network(loop_file, "loop")


@pytest.fixture(scope="session", params=TOWNS)
def town(request: pytest.FixtureRequest, shared_data: Path) -> RoadNetwork:
    """A real town, with lanes as a converter wrote them."""
    name: str = request.param
    return load_network(shared_data / "maps" / f"{name}.net.xml", name)


def _shipped() -> list[Path]:
    return sorted((Path(__file__).resolve().parents[2] / "sumo_nets").glob("*/*.net.xml"))


@pytest.fixture(scope="session", params=_shipped(), ids=lambda path: path.parent.name)
def shipped_network(request: pytest.FixtureRequest) -> RoadNetwork:
    path: Path = request.param
    return load_network(path, path.parent.name)
