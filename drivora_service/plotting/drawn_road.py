"""The road network as the background of a picture: lanes, junctions, sidewalks, dividing lines."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.lines import offset_line
from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.plotting import colors
from drivora_service.plotting.picture_view import View

_ARROW_MIN_LANE_M = 12.0


def draw_road(axes: Axes, network: RoadNetwork, view: View) -> None:
    """Draws the part of the network that the view shows."""
    lanes = [lane for lane in network.lanes if view.touches(lane.shape)]
    drivable = [_surface(lane) for lane in lanes if lane.drivable]
    drivable += [
        shapely.Polygon(shape)
        for shape in network.junction_shapes.values()
        if len(shape) >= 3 and view.touches(shape)
    ]
    walkable = [_surface(lane) for lane in lanes if lane.walkable and not lane.drivable]
    _fill(axes, walkable, colors.SIDEWALK, colors.SIDEWALK, z=1.0)
    _fill(axes, drivable, colors.ROAD, colors.ROAD_EDGE, z=2.0)
    _draw_dividers(axes, lanes)
    _draw_arrows(axes, lanes, view)


def _surface(lane: Lane) -> BaseGeometry:
    return shapely.LineString(lane.shape).buffer(
        0.5 * lane.width, cap_style="flat", join_style="round"
    )


def _fill(axes: Axes, surfaces: Iterable[BaseGeometry], face: str, edge: str, *, z: float) -> None:
    # A small buffer closes the gaps between adjacent lanes.
    merged = shapely.union_all([surface.buffer(0.05) for surface in surfaces])
    vertices: list[FloatArray] = []
    codes: list[NDArray[np.uint8]] = []
    for polygon in shapely.get_parts(merged):
        for ring in (polygon.exterior, *polygon.interiors):
            points = np.asarray(ring.coords)[:, :2]
            kinds = np.full(len(points), Outline.LINETO, dtype=np.uint8)
            kinds[0], kinds[-1] = Outline.MOVETO, Outline.CLOSEPOLY
            vertices.append(points)
            codes.append(kinds)
    if vertices:
        outline = Outline(np.concatenate(vertices), np.concatenate(codes))
        axes.add_patch(PathPatch(outline, facecolor=face, edgecolor=edge, linewidth=0.7, zorder=z))


def _draw_dividers(axes: Axes, lanes: Iterable[Lane]) -> None:
    """Draws broken lines between lanes of one direction, and solid ones at their left edge."""
    broken: list[FloatArray] = []
    solid: list[FloatArray] = []
    for lane in lanes:
        if lane.drivable and not lane.is_internal:
            border = offset_line(lane.shape, 0.5 * lane.width)
            (broken if lane.left >= 0 else solid).append(border)
    for lines, style, width in ((broken, (0, (4, 4)), 0.8), (solid, "solid", 0.6)):
        axes.add_collection(
            LineCollection(
                lines, colors=colors.LANE_MARK, linewidths=width, linestyles=style, zorder=2.2
            )
        )


def _draw_arrows(axes: Axes, lanes: Iterable[Lane], view: View) -> None:
    size = min(max(view.metres_an_inch * 0.07, 1.2), 5.0)
    chevrons = []
    for lane in lanes:
        if not lane.drivable or lane.is_internal or lane.arc[-1] < _ARROW_MIN_LANE_M:
            continue
        spacing = max(30.0, view.metres_an_inch * 1.6)
        count = max(1, int(lane.arc[-1] / spacing))
        for k in range(count):
            x, y, heading = lane.position_at(float(lane.arc[-1]) * (k + 0.35) / count)
            if not view.holds(x, y):
                continue
            ahead = np.array([np.cos(heading), np.sin(heading)]) * size
            left = np.array([-ahead[1], ahead[0]]) * 0.5
            tip = np.array([x, y]) + 0.5 * ahead
            chevrons.append(np.stack((tip - ahead + left, tip, tip - ahead - left)))
    axes.add_collection(
        LineCollection(chevrons, colors=colors.LANE_ARROW, linewidths=1.0, zorder=2.3)
    )
