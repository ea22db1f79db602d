"""Bird's-eye rasters of an ego's surroundings."""

from __future__ import annotations

import math

import numpy as np

from drivora_service.agents.interface import AgentContext, Observation
from drivora_service.agents.raster.perceived_boxes import PerceivedBoxes
from drivora_service.agents.raster.polygon_filling import Frame, Scratch
from drivora_service.agents.raster.raster_drawing import draw_boxes, draw_map, draw_route
from drivora_service.agents.raster.raster_map import raster_map
from drivora_service.agents.raster.raster_route import route_strip
from drivora_service.agents.raster.raster_settings import (
    HISTORIC,
    Channel,
    RasterSettings,
    check_out,
)
from drivora_service.geometry.array_shapes import ByteArray, IntArray
from drivora_service.observations.trace import Col

_BOX_CHANNELS = (Channel.VEHICLES, Channel.WALKERS, Channel.OBSTACLES, Channel.EGO)
"""Channels in the order of ``BoxKind``."""


class BirdsEyeRaster:
    """Draws images of what an ego observes on its map.

    The map shows all lanes around the ego, and of the actors those that the observation contains:
    with the range, the occlusion, the noise and the latency of its perception. What is more than
    3 m above or below the ego, as on a bridge, is left out.
    """

    def __init__(self, context: AgentContext, settings: RasterSettings) -> None:
        """Builds the static map and the strip of the route, and loads the compiled code."""
        self._settings = settings
        self._map = raster_map(context.network)
        self._strip = route_strip(context.network, context.route)
        self._half_length = 0.5 * context.model.length
        self._boxes = PerceivedBoxes(
            context.model, context.step_length, max(settings.history, default=0.0)
        )
        self._planes = _planes(settings)
        self._box_planes = [_box_planes(shown) for shown in _shown(settings)]
        height, width = settings.height, settings.width
        self._scratch = Scratch(
            marks=np.zeros((height, width + 1), dtype=np.uint8),
            spans=np.tile(np.array([width + 1, -1], dtype=np.int32), (height, 1)),
            corners=np.zeros((4, 2)),
            area_turns=np.zeros(len(self._map.circles), dtype=np.int64),
            line_turns=np.zeros(len(self._map.lines), dtype=np.int64),
        )
        self._turn = 0
        # The first image of a process compiles or loads the kernels, outside of any step.
        self._paint(np.zeros(settings.shape, dtype=np.uint8), _nothing(context))
        self._boxes.forget()

    @property
    def settings(self) -> RasterSettings:
        """What it shows."""
        return self._settings

    def draw(self, observation: Observation, out: ByteArray | None = None) -> ByteArray:
        """Returns the image of the current step; see ``Raster.draw``."""
        if out is None:
            out = np.zeros(self._settings.shape, dtype=np.uint8)
        else:
            check_out(out, self._settings)
            out.fill(0)
        self._paint(out, observation)
        return out

    def _paint(self, out: ByteArray, observation: Observation) -> None:
        settings = self._settings
        self._turn += 1
        x, y, yaw = observation.ego[Col.X : Col.YAW + 1].tolist()
        frame = Frame(
            x=x,
            y=y,
            z=float(observation.ego[Col.Z]),
            cos=math.cos(yaw),
            sin=math.sin(yaw),
            scale=1.0 / settings.metres_per_pixel,
            row=settings.ego_from_top * settings.height,
            column=settings.ego_from_left * settings.width,
        )
        draw_map(out, self._planes, frame, self._map, self._scratch, self._turn)
        line_s = observation.route_s + self._half_length + observation.light_distance
        draw_route(
            out, self._planes, frame, self._strip, self._scratch,
            float(observation.route_s), int(observation.light), float(line_s),
        )  # fmt: skip
        self._boxes.record(observation)
        for before, planes in zip((0.0, *settings.history), self._box_planes, strict=True):
            found = self._boxes.at(observation.time - before)
            if found is not None:
                draw_boxes(out, planes, frame, *found, self._scratch)


def _planes(settings: RasterSettings) -> IntArray:
    """Returns the place of each channel on the image's first axis, or -1."""
    planes = np.full(len(Channel), -1, dtype=np.int64)
    for place, channel in enumerate(settings.channels):
        planes[channel] = place
    return planes


def _shown(settings: RasterSettings) -> list[dict[Channel, int]]:
    """Returns the places of the actors' channels: those of now, then of each earlier time."""
    now = {c: place for place, c in enumerate(settings.channels) if c in _BOX_CHANNELS}
    repeated = [channel for channel in settings.channels if channel in HISTORIC]
    begin = len(settings.channels)
    earlier = [
        {channel: begin + nth * len(repeated) + k for k, channel in enumerate(repeated)}
        for nth in range(len(settings.history))
    ]
    return [now, *earlier]


def _box_planes(shown: dict[Channel, int]) -> IntArray:
    return np.array([shown.get(channel, -1) for channel in _BOX_CHANNELS], dtype=np.int64)


def _nothing(context: AgentContext) -> Observation:
    """Returns an observation of an empty road at the begin of the route."""
    ego = np.zeros(len(Col))
    ego[:2] = context.route.line[0]
    return Observation(
        ego=ego,
        objects=np.zeros((0, len(Col))),
        object_sizes=np.zeros((0, 2)),
        object_kinds=np.zeros(0, dtype=np.int64),
        object_ids=np.zeros(0, dtype=np.int64),
    )
