"""Pictures of runs, drawn on request and kept in memory."""

from __future__ import annotations

import asyncio
import math
from collections import OrderedDict
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from http import HTTPStatus
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

from fastapi import Depends, Query, Request, Response

from drivora_service.api.context import ApiContext
from drivora_service.api.guards.compression import compressed_answer, negotiate_coding
from drivora_service.api.guards.entity_tags import digest, is_known
from drivora_service.api.problem_details import ApiError
from drivora_service.errors import UnknownName
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.oracles.verdicts.verdict_json import verdict_to_json

if TYPE_CHECKING:
    from drivora_service.networks.road_network import RoadNetwork
    from drivora_service.observations.trace_files.stored_trace import StoredTrace

SVG = "image/svg+xml"

MOST_BYTES = 64 << 20
"""Of all pictures that are kept."""
MOST_WAITING = 64
"""Pictures that wait to be drawn."""

Moments = Annotated[
    int, Query(ge=2, le=12, description="Moments side by side; fewer if the run is too short.")
]


@dataclass(frozen=True, slots=True, kw_only=True)
class AskedViolation:
    """The violation that the moments of a picture lead to.

    Attributes:
        oracle: The oracle; "": the gravest violation of the run.
        ego: Id of the ego; "": of any.
        step: Row of the trace at which it begins; ``None``: the earliest.
    """

    oracle: str = ""
    ego: str = ""
    step: int | None = None

    def find_in(self, verdicts: Sequence[Verdict]) -> Verdict | None:
        """Returns the violation; ``None`` for the gravest.

        Raises:
            UnknownName: The run has no such violation.
        """
        if not self.oracle:
            return None
        found = [
            one
            for one in verdicts
            if one.outcome is Outcome.VIOLATED
            and one.oracle == self.oracle
            and self.ego in ("", one.ego)
            and self.step in (None, one.step)
        ]
        if not found:
            violated = {one.oracle for one in verdicts if one.outcome is Outcome.VIOLATED}
            raise UnknownName("violation", self.oracle, tuple(sorted(violated)))
        return min(found, key=lambda one: math.inf if one.step is None else one.step)


def read_asked_violation(
    oracle: Annotated[
        str,
        Query(
            max_length=60,
            description="The moments lead to a violation of this oracle; without it, to the "
            "gravest of the run.",
        ),
    ] = "",
    ego: Annotated[
        str, Query(max_length=200, description="With `oracle`: of the ego with this id.")
    ] = "",
    step: Annotated[
        int | None,
        Query(
            ge=0,
            description="With `oracle`: the violation that begins in this row of the trace, not "
            "the earliest.",
        ),
    ] = None,
) -> AskedViolation:
    """Reads from a request which violation its picture shows."""
    return AskedViolation(oracle=oracle, ego=ego, step=step)


Asked = Annotated[AskedViolation, Depends(read_asked_violation)]


class Pictures:
    """Draws one picture at a time and keeps the last ones; used in one event loop.

    The drawing library keeps settings for the whole process, so two threads must not draw at once.
    A request that waits holds no thread: others are answered meanwhile.
    """

    def __init__(self, most_bytes: int = MOST_BYTES, most_waiting: int = MOST_WAITING) -> None:
        """Creates it without pictures.

        Args:
            most_bytes: Bytes of all pictures that are kept.
            most_waiting: Pictures that wait to be drawn; further ones are refused.
        """
        self._most_bytes, self._most_waiting = most_bytes, most_waiting
        self._drawer = ThreadPoolExecutor(max_workers=1, thread_name_prefix="pictures")
        self._waiting: dict[str, asyncio.Future[bytes]] = {}
        self._kept: OrderedDict[str, bytes] = OrderedDict()
        self._bytes = 0

    async def strip(
        self,
        name: str,
        stored: StoredTrace,
        network: RoadNetwork,
        verdicts: Sequence[Verdict],
        *,
        moments: int,
        shown: Verdict | None = None,
    ) -> bytes:
        """Returns a strip of moments of a run as SVG.

        Args:
            name: Stands for the picture's content; equal requests wait for one drawing.
            stored: Trace of the run.
            network: Its road network.
            verdicts: Its verdicts.
            moments: Number of moments.
            shown: The violation that determines the moments; ``None``: the gravest.

        Raises:
            ApiError: Too many pictures wait to be drawn.
            TraceDamaged: The file is not the trace that was recorded.
        """
        if name in self._kept:
            self._kept.move_to_end(name)
            return self._kept[name]
        drawn = self._waiting.get(name)
        if drawn is None:
            if len(self._waiting) >= self._most_waiting:
                raise ApiError(
                    HTTPStatus.SERVICE_UNAVAILABLE,
                    "too many pictures are being drawn; ask again in a few seconds",
                    headers={"Retry-After": "2"},
                )
            drawn = self._waiting[name] = asyncio.get_running_loop().run_in_executor(
                self._drawer, _draw, stored, network, verdicts, moments, shown
            )
            drawn.add_done_callback(partial(self._keep_picture, name))
        # The client may go: others wait for the same, and it is kept.
        return await asyncio.shield(drawn)

    def _keep_picture(self, name: str, drawn: asyncio.Future[bytes]) -> None:
        del self._waiting[name]
        if drawn.cancelled() or drawn.exception() is not None:
            return
        picture = drawn.result()
        self._kept[name] = picture
        self._bytes += len(picture)
        while self._bytes > self._most_bytes:
            _, oldest = self._kept.popitem(last=False)
            self._bytes -= len(oldest)


async def picture_answer(
    request: Request,
    context: ApiContext,
    stored: StoredTrace,
    *,
    town: str,
    verdicts: Sequence[Verdict],
    moments: int,
    asked: AskedViolation,
) -> Response:
    """Answers with the strip of a run, which is drawn unless the client or the memory has it.

    Args:
        request: The request.
        context: The application's context.
        stored: Trace of the run.
        town: Name of its road network.
        verdicts: Its verdicts.
        moments: Number of moments.
        asked: The violation that the moments lead to.

    Raises:
        UnknownName: The road network is not in the catalogue any more, or the run has no such
            violation.
        TraceDamaged: The file is not the trace that was recorded.
    """
    shown = asked.find_in(verdicts)
    network = await asyncio.to_thread(context.networks.get, town)
    # Equal recordings may have been judged by different oracles, and drawn by another version.
    judged = digest("".join(verdict_to_json(one) for one in verdicts).encode())
    parts = (stored.sha256[:32], network.sha256[:16], judged[:16], version("drivora"))
    which = () if shown is None else (digest(verdict_to_json(shown).encode())[:16],)
    etag = "-".join((*parts, str(moments), *which))
    _, headers = negotiate_coding(request, etag)
    if is_known(request, headers["ETag"].strip('"')):
        return Response(status_code=304, headers=headers)
    pictures: Pictures = request.app.state.pictures
    picture = await pictures.strip(etag, stored, network, verdicts, moments=moments, shown=shown)
    return compressed_answer(request, lambda: picture, media_type=SVG, etag=etag)


def _draw(
    stored: StoredTrace,
    network: RoadNetwork,
    verdicts: Sequence[Verdict],
    moments: int,
    shown: Verdict | None,
) -> bytes:
    # Imported here: it takes half a second, and many services never draw.
    from drivora_service.observations.trace_files.checked_trace import read_checked_trace
    from drivora_service.plotting.strip import draw_strip

    with TemporaryDirectory() as folder:
        target = Path(folder) / "run.svg"
        trace = read_checked_trace(stored)
        draw_strip(trace, network, verdicts, target, count=moments, shown=shown)
        return target.read_bytes()
