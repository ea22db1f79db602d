"""Details of a network that are drawn or named, and that nothing is simulated or judged by."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from xml.etree import ElementTree

from drivora_service.networks.road_network import RoadNetwork

_ALL = "all"
_CAR = "passenger"


@dataclass(frozen=True, slots=True, kw_only=True)
class EdgeDetails:
    """An edge.

    Attributes:
        begin: Junction at which it begins; "" inside junctions.
        end: Junction at which it ends; "" inside junctions.
        function: SUMO's word: "normal", "internal", "crossing", "walkingarea", "connector".
        street: Name of the street; "" if the network has none.
        crosses: Edges that a crossing crosses.
    """

    begin: str
    end: str
    function: str
    street: str
    crosses: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RoadDetails:
    """Details of a network.

    Attributes:
        junction_types: SUMO's type of each junction by its id ("priority", "traffic_light", …).
        edges: By id.
        no_change_left: Ids of lanes from which cars must not change to the left.
        no_change_right: The same to the right.
    """

    junction_types: Mapping[str, str]
    edges: Mapping[str, EdgeDetails]
    no_change_left: frozenset[str]
    no_change_right: frozenset[str]


@lru_cache(maxsize=32)
def road_details(network: RoadNetwork) -> RoadDetails:
    """Returns the details of a network, read once from its file."""
    junction_types: dict[str, str] = {}
    edges: dict[str, EdgeDetails] = {}
    fixed: dict[str, set[str]] = {"changeLeft": set(), "changeRight": set()}
    for _, element in ElementTree.iterparse(network.path):
        if element.tag == "junction":
            if element.get("type") != "internal":
                junction_types[element.get("id", "")] = element.get("type", "")
        elif element.tag == "edge":
            edges[element.get("id", "")] = EdgeDetails(
                begin=element.get("from", ""),
                end=element.get("to", ""),
                function=element.get("function", "normal"),
                street=element.get("name", ""),
                crosses=tuple(element.get("crossingEdges", "").split()),
            )
            for lane in element.iter("lane"):
                name = lane.get("id", "")
                for attribute, found in fixed.items():
                    allowed = lane.get(attribute)
                    if allowed is not None and not {_ALL, _CAR} & set(allowed.split()):
                        found.add(name)
        else:
            continue
        element.clear()
    return RoadDetails(
        junction_types=junction_types,
        edges=edges,
        no_change_left=frozenset(fixed["changeLeft"]),
        no_change_right=frozenset(fixed["changeRight"]),
    )
