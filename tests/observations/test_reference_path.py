"""Paths of egos: thinned within tolerances, compared in pieces, stored with the trace."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely import LineString, Point

from drivora_service.errors import StoreError
from drivora_service.observations.reference_path import (
    distances_to_line,
    path_overlap,
    piece_middles,
    poses_at,
    recorded_path,
    reference_of,
)
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import PoseCol, Trace
from drivora_service.observations.trace_files.trace_file import read_trace, write_trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.testing.networks import straight_road
from drivora_service.testing.traces import Motion, SyntheticEgo, make_trace

Floats = NDArray[np.float64]


def driven(x: Floats, y: Floats) -> Trace:
    route = np.array([(0.0, 0.0), (400.0, 0.0)])
    return make_trace([SyntheticEgo(motion=Motion.along(x, y), route=route)])


def view_of(trace: Trace) -> EgoView:
    return RunView(trace, straight_road()).egos[0]


speeds = st.lists(st.floats(0.0, 30.0), min_size=2, max_size=6)
turns = st.lists(st.floats(-0.6, 0.6), min_size=2, max_size=6)


@given(speeds=speeds, turns=turns)
def test_a_thinned_path_gives_all_poses_within_the_tolerances(
    speeds: list[float], turns: list[float]
) -> None:
    steps = 300
    speed = np.interp(np.linspace(0, 1, steps), np.linspace(0, 1, len(speeds)), speeds)
    rate = np.interp(np.linspace(0, 1, steps), np.linspace(0, 1, len(turns)), turns)
    yaw = np.cumsum(rate) * 0.05
    x, y = np.cumsum(speed * np.cos(yaw)) * 0.05, np.cumsum(speed * np.sin(yaw)) * 0.05
    ego = view_of(driven(x, y))
    path = recorded_path(ego)
    assert (np.diff(path[:, PoseCol.TIME]) > 0.0).all()
    assert (np.abs(path[:, PoseCol.YAW]) <= math.pi + 1e-4).all()
    again = poses_at(path, ego.times)
    # Decimals are rounded, too.
    assert np.abs(again[:, 1:3] - ego.states[:, :2]).max() < 0.0202
    turn = again[:, PoseCol.YAW] - ego.states[:, 2]
    assert np.abs(np.arctan2(np.sin(turn), np.cos(turn))).max() < 0.0102
    assert np.abs(again[:, PoseCol.SPEED] - ego.speed).max() < 0.0502


def test_standing_and_steady_driving_take_few_poses() -> None:
    x = np.concatenate((np.zeros(2000), 0.5 * np.arange(2000)))
    path = recorded_path(view_of(driven(x, np.zeros(len(x)))))
    assert len(path) < 10


# Multiples of a tenth of a millimetre: shapely has no distance to lines of less than 1e-154 m.
metres = st.integers(-1_000_000, 1_000_000).map(lambda number: number / 10_000)
lines = st.lists(st.tuples(metres, metres), min_size=2, max_size=8).map(np.array)


@given(line=lines, other=lines)
def test_distances_and_pieces_are_those_of_shapely(line: Floats, other: Floats) -> None:
    middles = piece_middles(line, 2.0)
    shape = LineString(other)
    expected = [Point(*point).distance(shape) for point in middles]
    assert distances_to_line(middles, other) == pytest.approx(expected, abs=1e-5)
    along = LineString(line)
    wanted = [along.interpolate(2.0 * k + 1.0) for k in range(round(along.length / 2.0))]
    for point, place in zip(middles, wanted, strict=False):
        assert math.dist(point, (place.x, place.y)) < 1e-6


@given(line=lines, other=lines)
def test_the_comparison_is_symmetric_up_to_a_piece_and_in_its_range(
    line: Floats, other: Floats
) -> None:
    overlap, distance = path_overlap(line, other, piece=2.0, half_width=1.6)
    _, back = path_overlap(other, line, piece=2.0, half_width=1.6)
    assert 0.0 <= overlap <= 1.0
    assert distance == back >= 0.0
    same, none = path_overlap(line, line, piece=2.0, half_width=1.6)
    assert same == 1.0
    assert none == pytest.approx(0.0, abs=1e-5)


def test_a_trace_keeps_the_paths_that_its_scenario_has(tmp_path: Path) -> None:
    plain = driven(np.arange(50.0), np.zeros(50))
    path = np.array([(0.0, 0.1, 0.2, 0.3, 0.4, 0.5), (1.0, 1.1, 1.2, 1.3, 1.4, 1.5)])
    with_path = replace(plain, references=(path,))
    for trace in (plain, with_path):
        write_trace(trace, tmp_path / "run.parquet")
        found = reference_of(view_of(read_trace(tmp_path / "run.parquet")))
        assert (found is None) is (trace is plain)
        assert found is None or np.array_equal(found, path)
    # The hash of the scenario, which is part of that of the trace, covers it.
    assert trace_sha256(plain) == trace_sha256(with_path)


@pytest.mark.parametrize(
    "path",
    [
        np.array([(1.0, 0, 0, 0, 0, 0), (0.5, 1, 0, 0, 0, 0)]),
        np.array([(0.0, 0, 0, 0, 0, 0), (0.5, np.nan, 0, 0, 0, 0)]),
        np.array([(0.0, 0, 0, 0, 0, 0)]),
    ],
)
def test_a_file_with_an_impossible_path_is_refused(path: Floats, tmp_path: Path) -> None:
    trace = replace(driven(np.arange(50.0), np.zeros(50)), references=(path,))
    write_trace(trace, tmp_path / "run.parquet")
    with pytest.raises(StoreError):
        read_trace(tmp_path / "run.parquet")
