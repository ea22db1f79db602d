"""Stop lines in the colour of their signal when an ego reached them."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.observations.trace import Col, Light, Trace
from drivora_service.plotting import colors
from drivora_service.plotting.picture_view import View

_PASSED_WITHIN_M = 2.5

_LIGHT_OF_LETTER = {
    "G": Light.GREEN,
    "g": Light.GREEN,
    "y": Light.YELLOW,
    "Y": Light.YELLOW,
    "u": Light.RED,
    "r": Light.RED,
}


def draw_signals(
    axes: Axes, trace: Trace, network: RoadNetwork, view: View, *, step: int | None = None
) -> bool:
    """Draws the signals in view; returns whether there are any.

    A stop line has the colour of its signal at ``step``; by default when the first ego crossed
    it, or, if none did, at the end of the run.
    """
    bars, shades = [], []
    columns = {light: column for column, light in enumerate(trace.light_ids)}
    for lane in network.lanes:
        link = next((c for c in lane.connections if c.traffic_light in columns), None)
        if link is None or lane.is_internal or not lane.drivable:
            continue
        x, y, heading = lane.position_at(float(lane.arc[-1]))
        if not view.holds(x, y):
            continue
        shown = _first_passage(trace, lane) if step is None else step
        state = trace.light_state_names[trace.light_states[shown, columns[link.traffic_light]]]
        across = np.array([-np.sin(heading), np.cos(heading)]) * 0.5 * lane.width
        bars.append(np.array([x, y]) + np.stack((across, -across)))
        shades.append(colors.LIGHTS[_LIGHT_OF_LETTER.get(state[link.link_index], Light.NONE)])
    if bars:
        axes.add_collection(
            LineCollection(bars, colors=shades, linewidths=3.2, capstyle="butt", zorder=4.8)
        )
    return bool(bars)


def _first_passage(trace: Trace, lane: Lane) -> int:
    """Returns the row at which the first ego was at the lane's end, or the last row."""
    offsets = trace.states[:, : trace.ego_count, [Col.X, Col.Y]] - lane.shape[-1]
    close = np.hypot(offsets[..., 0], offsets[..., 1]) < max(_PASSED_WITHIN_M, 0.5 * lane.width)
    rows = np.flatnonzero(close.any(axis=1))
    return int(rows[0]) if len(rows) else trace.step_count - 1
