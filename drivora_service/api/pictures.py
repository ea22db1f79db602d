"""Pictures of runs, drawn on request and kept in memory."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Sequence
from http import HTTPStatus
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

from fastapi import Query, Request, Response

from drivora_service.api.compression import compressed_answer
from drivora_service.api.context import ApiContext
from drivora_service.api.problems import ApiError
from drivora_service.oracles.verdict import Verdict

if TYPE_CHECKING:
    from drivora_service.networks.road_network import RoadNetwork

SVG = "image/svg+xml"

MOST_BYTES = 64 << 20
"""Of all pictures that are kept."""
MOST_WAITING = 16
"""Requests that wait for their pictures; each holds a thread."""

Moments = Annotated[
    int, Query(ge=2, le=12, description="Moments side by side; fewer if the run is too short.")
]


class Pictures:
    """Draws one picture at a time and keeps the last ones.

    The drawing library keeps settings for the whole process, so two threads must not draw at once.
    """

    def __init__(self, most_bytes: int = MOST_BYTES, most_waiting: int = MOST_WAITING) -> None:
        """Keeps none yet.

        Args:
            most_bytes: Bytes of all pictures that are kept.
            most_waiting: Requests that wait; further ones are refused.
        """
        self._most_bytes = most_bytes
        self._places = threading.BoundedSemaphore(most_waiting)
        self._drawing = threading.Lock()
        self._kept: OrderedDict[str, bytes] = OrderedDict()
        self._bytes = 0

    def strip(
        self,
        name: str,
        path: Path,
        network: RoadNetwork,
        verdicts: Sequence[Verdict],
        *,
        moments: int,
    ) -> bytes:
        """Returns a strip of moments of a run as SVG.

        Args:
            name: Stands for the picture's content.
            path: Trace of the run.
            network: Its road network.
            verdicts: Its verdicts; the gravest violation determines the moments.
            moments: Number of moments.

        Raises:
            ApiError: Too many requests wait for pictures.
            StoreError: The trace cannot be read.
        """
        if not self._places.acquire(blocking=False):
            raise ApiError(
                HTTPStatus.SERVICE_UNAVAILABLE,
                "too many pictures are being drawn; ask again in a few seconds",
                headers={"Retry-After": "2"},
            )
        try:
            with self._drawing:
                if name in self._kept:
                    self._kept.move_to_end(name)
                    return self._kept[name]
                picture = _draw(path, network, verdicts, moments)
                self._keep(name, picture)
                return picture
        finally:
            self._places.release()

    def _keep(self, name: str, picture: bytes) -> None:
        self._kept[name] = picture
        self._bytes += len(picture)
        while self._bytes > self._most_bytes:
            _, oldest = self._kept.popitem(last=False)
            self._bytes -= len(oldest)


def picture_answer(
    request: Request,
    context: ApiContext,
    path: Path,
    *,
    trace_sha256: str,
    town: str,
    verdicts: Sequence[Verdict],
    moments: int,
) -> Response:
    """Answers with the strip of a run, which is drawn unless the client or the memory has it.

    Args:
        request: The request.
        context: The application's context.
        path: Trace of the run.
        trace_sha256: Its hash.
        town: Name of its road network.
        verdicts: Its verdicts.
        moments: Number of moments.

    Raises:
        UnknownName: The road network is not in the catalogue any more.
    """
    network = context.networks.get(town)
    etag = f"{trace_sha256[:32]}-{network.sha256[:16]}-{moments}"
    pictures: Pictures = request.app.state.pictures
    return compressed_answer(
        request,
        lambda: pictures.strip(etag, path, network, verdicts, moments=moments),
        media_type=SVG,
        etag=etag,
    )


def _draw(path: Path, network: RoadNetwork, verdicts: Sequence[Verdict], moments: int) -> bytes:
    # Imported here: it takes half a second, and many services never draw.
    from drivora_service.observations.trace_file import read_trace
    from drivora_service.plotting.strip import draw_strip

    with TemporaryDirectory() as folder:
        target = Path(folder) / "run.svg"
        draw_strip(read_trace(path), network, verdicts, target, count=moments)
        return target.read_bytes()
