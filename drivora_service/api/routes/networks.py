"""Road networks that scenarios may take place on."""

from __future__ import annotations

from fastapi import Depends, Request, Response

from drivora_service.api import examples
from drivora_service.api.compression import compressed_answer
from drivora_service.api.conditional import JSON, json_answer
from drivora_service.api.context import Context
from drivora_service.api.documentation import answers
from drivora_service.api.network_geometry import GEOMETRY_VERSION, geometry_json
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.catalogues import (
    Network,
    NetworkList,
    NetworkSummary,
)
from drivora_service.api.schemas.network_geometry import NetworkGeometry
from drivora_service.api.security import reader
from drivora_service.api_paths import PREFIX
from drivora_service.networks.road_network import RoadNetwork

router = resource_router("networks", Depends(reader))


@router.get("/networks", response_model=NetworkList, responses=answers(examples.NETWORKS, 401, 403))
def list_networks(request: Request, context: Context) -> Response:
    """Lists the networks, shipped and imported."""
    items = tuple(
        NetworkSummary(name=name, url=f"{PREFIX}/networks/{name}")
        for name in context.networks.names()
    )
    return json_answer(request, NetworkList, NetworkList(items=items))


@router.get(
    "/networks/{name:id}",
    response_model=Network,
    responses=answers(examples.NETWORK, 401, 403, 404),
)
def get_network(request: Request, context: Context, name: str) -> Response:
    """Describes a network."""
    network = context.networks.get(name)
    return json_answer(request, Network, network_view(network), etag=network.sha256)


@router.get(
    "/networks/{name:id}/geometry",
    response_model=NetworkGeometry,
    responses=answers(examples.GEOMETRY, 401, 403, 404),
)
def get_geometry(request: Request, context: Context, name: str) -> Response:
    """Returns what is needed to draw a network: lanes, junctions, crossings, lights, signs."""
    network = context.networks.get(name)
    etag = f"{network.sha256}-geometry-{GEOMETRY_VERSION}"
    return compressed_answer(request, lambda: geometry_json(network), media_type=JSON, etag=etag)


def network_view(network: RoadNetwork) -> Network:
    """Returns a network as the API shows it."""
    driven = [lane for lane in network.lanes if lane.drivable and not lane.is_internal]
    return Network(
        name=network.name,
        sha256=network.sha256,
        bounds=network.bounds,
        net_offset=network.net_offset,
        lanes=len(network.lanes),
        drivable_km=round(sum(lane.length for lane in driven) / 1000.0, 3),
        traffic_lights=len(network.programs),
        has_sidewalks=any(lane.walkable and not lane.drivable for lane in network.lanes),
        geometry_url=f"{PREFIX}/networks/{network.name}/geometry",
    )
