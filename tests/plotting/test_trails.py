from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from drivora_service.observations.trace import Col, Role, Trace
from drivora_service.plotting.picture_file import add_map, open_picture
from drivora_service.plotting.picture_view import view_of_run
from drivora_service.plotting.strip import fit_title
from drivora_service.plotting.trails import draw_trails, entries, split_trail
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace

STEPS = 60


@pytest.fixture
def trace() -> Trace:
    """A background vehicle that leaves at row 20, enters 300 m away at 30, and jumps at 45."""
    ego = SyntheticEgo(motion=Motion.steady(0.0, 0.0, steps=STEPS, speed=5.0))
    car = SyntheticActor(
        motion=Motion.steady(10.0, 0.0, steps=STEPS, speed=8.0),
        id="background:0",
        role=Role.BACKGROUND,
    )
    made = make_trace([ego], [car])
    present, states = made.present.copy(), made.states.copy()
    present[20:30, 1] = False
    states[30:, 1, Col.X] += 300.0
    states[45:, 1, Col.Y] += 200.0
    return replace(made, present=present, states=states)


def path_of(trace: Trace) -> tuple[np.ndarray, np.ndarray]:
    rows = np.flatnonzero(trace.present[:, 1])
    return rows, trace.states[rows, 1][:, [Col.X, Col.Y]]


def test_entries_are_found(trace: Trace) -> None:
    rows, path = path_of(trace)
    assert rows[entries(trace, rows, path)].tolist() == [0, 30, 45]


def test_no_line_crosses_the_map_to_where_a_vehicle_enters_anew(trace: Trace) -> None:
    trail = split_trail(trace, *path_of(trace))
    drawn = np.hypot(*np.diff(trail, axis=0).T)
    assert np.isnan(trail[:, 0]).sum() == 2
    assert np.nanmax(drawn) < 1.0
    figure = Figure(figsize=(4.0, 4.0))
    view = view_of_run(trace, ())
    axes = add_map(figure, view, left_in=0.0, bottom_in=0.0)
    draw_trails(axes, trace, view, by_time=False)
    paths = [np.asarray(line.get_xydata()) for line in axes.lines]
    longest = max(
        np.nanmax(np.hypot(*np.diff(path, axis=0).T)) for path in paths if len(path) > STEPS // 2
    )
    assert longest < 10.0


@pytest.mark.parametrize("width_in", [2.3, 4.4, 11.0])
def test_a_long_title_stays_inside_its_picture(width_in: float, tmp_path: Path) -> None:
    text = "collision at 12.35 s with background:17 (at fault, not avoidable) " * 2
    title, size = fit_title(text.strip(), width_in)
    assert " ".join(title.split()) == text.strip()
    with open_picture(tmp_path / "x.png", width_in=width_in, height_in=1.0) as figure:
        drawn = figure.text(0.0, 0.5, title, fontsize=size, fontweight="bold")
        figure.draw_without_rendering()
        extent = drawn.get_window_extent()
        assert extent.width <= figure.bbox.width
        assert extent.height <= 0.36 * figure.dpi
