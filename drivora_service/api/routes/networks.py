"""Road networks that scenarios may take place on."""

from __future__ import annotations

import asyncio
from typing import Annotated

import structlog
from fastapi import Depends, Query, Request, Response

from drivora_service.api.answers import request_bodies
from drivora_service.api.answers.geometry_json import GEOMETRY_VERSION, geometry_json
from drivora_service.api.answers.network_imports import Upload
from drivora_service.api.context import ApiContext, Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import answers, network_body
from drivora_service.api.guards.authorization import administrator, client_name, reader
from drivora_service.api.guards.compression import compressed_answer
from drivora_service.api.guards.entity_tags import JSON, json_answer
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.catalogues import (
    Network,
    NetworkList,
    NetworkSummary,
)
from drivora_service.api.schemas.network_geometry import NetworkGeometry
from drivora_service.errors import Conflict, NothingStored
from drivora_service.networks.importing.source_formats import SourceFormat
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.shapes import to_json

router = resource_router("networks", Depends(reader))

_log = structlog.stdlib.get_logger(__name__)

_Name = Annotated[
    str,
    Query(
        description="Name of the network: 1 to 64 letters, digits, `-` and `_`.",
        # Checked below, with an error that names what is allowed.
        json_schema_extra={"pattern": "^[A-Za-z0-9_-]{1,64}$"},
    ),
]
_Format = Annotated[SourceFormat, Query(alias="format", description="Format of the file.")]
_Replace = Annotated[
    bool,
    Query(
        description="Whether it replaces an imported network of this name, which no unfinished run "
        "is on."
    ),
]


@router.get(
    "/networks", response_model=NetworkList, responses=answers(recorded_examples.NETWORKS, 401, 403)
)
def list_networks(request: Request, context: Context) -> Response:
    """Lists the networks, shipped and imported."""
    items = tuple(
        NetworkSummary(name=name, url=f"{context.base}/networks/{name}")
        for name in context.networks.names()
    )
    return json_answer(request, NetworkList, NetworkList(items=items))


@router.post(
    "/networks",
    status_code=201,
    response_model=Network,
    responses=answers(recorded_examples.NETWORK, 401, 403, 409, 413, 415, 422, 429, status=201),
    openapi_extra=network_body(recorded_examples.NETWORK_FILE),
    dependencies=[Depends(administrator)],
)
async def import_network(
    request: Request, context: Context, name: _Name, form: _Format, replace: _Replace = False
) -> Response:
    """Imports the road network whose file is the body; `Location` is the network.

    The file is imported by a process of its own, with limits of its memory and time. One network is
    imported at a time. If the client leaves before the answer, nothing is imported.
    """
    request_bodies.media_type(request, request_bodies.XML_TYPES)
    upload = Upload(name=name, format=form, replace=replace)
    await context.imports.take(request, upload, lambda: _refuse_use(context, name))
    network = await asyncio.to_thread(context.networks.get, name)
    _log.info(
        "network_imported",
        network=name,
        sha256=network.sha256,
        replaced=replace,
        client=client_name(request),
    )
    return Response(
        to_json(Network, network_view(network, context.base)),
        status_code=201,
        media_type=JSON,
        headers={"Location": f"{context.base}/networks/{name}"},
    )


@router.get(
    "/networks/{name:id}",
    response_model=Network,
    responses=answers(recorded_examples.NETWORK, 401, 403, 404),
)
def get_network(request: Request, context: Context, name: str) -> Response:
    """Describes a network."""
    network = context.networks.get(name)
    return json_answer(request, Network, network_view(network, context.base), etag=network.sha256)


@router.get(
    "/networks/{name:id}/geometry",
    response_model=NetworkGeometry,
    responses=answers(recorded_examples.GEOMETRY, 401, 403, 404),
)
def get_geometry(request: Request, context: Context, name: str) -> Response:
    """Returns what is needed to draw a network: lanes, junctions, crossings, lights, signs."""
    network = context.networks.get(name)
    etag = f"{network.sha256}-geometry-{GEOMETRY_VERSION}"
    return compressed_answer(request, lambda: geometry_json(network), media_type=JSON, etag=etag)


def network_view(network: RoadNetwork, base: str) -> Network:
    """Returns a network as the API shows it; ``base`` is the address of the API."""
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
        geometry_url=f"{base}/networks/{network.name}/geometry",
    )


def _refuse_use(context: ApiContext, name: str) -> None:
    """Refuses to replace a network of unfinished work, which was checked on it as it is.

    Raises:
        Conflict: There is such work.
    """
    try:
        with context.database.read() as transaction:
            use = transaction.network_use(name)
    except NothingStored:
        return
    if use.counted:
        raise Conflict(
            f"network {name!r} cannot be replaced while work on it is unfinished ({use.counted}); "
            "wait until it has ended, cancel it, or import the network under another name"
        )
