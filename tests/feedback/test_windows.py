"""Statistics of motion in windows, against values worked out by hand."""

from __future__ import annotations

from math import sqrt
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.feedback.windows import (
    SIGNALS,
    STATISTICS,
    motion_signals,
    window_statistics,
)
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.run_view import EgoView
from drivora_service.testing.networks import straight_road
from drivora_service.testing.traces import Motion, SyntheticEgo, make_trace

ROAD = straight_road()


def statistics(*values: float) -> dict[str, float]:
    """Returns the statistics of one signal over one window."""
    (row,) = window_statistics(np.array(values, dtype=float)[:, None], len(values), 1)
    return dict(zip(STATISTICS, row.tolist(), strict=True))


def signals(motion: Motion, sample: float = 0.1, **fields: Any) -> dict[str, FloatArray]:
    ego = EgoView(make_trace([SyntheticEgo(motion=motion, **fields)]), ROAD, 0)
    return dict(zip(SIGNALS, motion_signals(ego, sample).T, strict=True))


def test_a_signal_worked_out_by_hand() -> None:
    # Mean 3, squared deviations 4 + 1 + 1 + 0 + 4 = 10, changes 1, 2, -1, 2.
    assert statistics(1.0, 2.0, 4.0, 3.0, 5.0) == {
        "mean": 3.0,
        "variance": 2.0,
        "min": 1.0,
        "max": 5.0,
        "mean_change": 1.0,
        "mean_abs_change": 1.5,
        "c3": pytest.approx((1 * 2 * 4 + 2 * 4 * 3 + 4 * 3 * 5) / 3, abs=1e-6),
        "cid_ce": pytest.approx(sqrt(1 + 4 + 1 + 4) / sqrt(2), abs=1e-6),
    }


def test_another_signal_worked_out_by_hand() -> None:
    found = statistics(1.0, -1.0, 1.0, -1.0)
    assert found["mean_change"] == pytest.approx(-2 / 3, abs=1e-6)
    assert found["c3"] == 0.0
    assert found["cid_ce"] == pytest.approx(sqrt(12.0))


@pytest.mark.parametrize("value", [0.0, 0.1, -7.3])
def test_a_constant_signal_is_not_rough(value: float) -> None:
    assert statistics(*[value] * 10) == {
        "mean": pytest.approx(value),
        "variance": 0.0,
        "min": value,
        "max": value,
        "mean_change": 0.0,
        "mean_abs_change": 0.0,
        "c3": pytest.approx(value**3),
        "cid_ce": 0.0,
    }


def test_rounding_errors_of_a_constant_signal_are_not_blown_up() -> None:
    assert statistics(*(0.3 + 1e-12 * np.array([0, 1, -1, 1, 0, -1])))["cid_ce"] == 0.0


def test_the_roughness_does_not_depend_on_the_scale() -> None:
    one, other = statistics(1.0, 2.0, 4.0, 3.0), statistics(10.0, 20.0, 40.0, 30.0)
    assert one["cid_ce"] == pytest.approx(other["cid_ce"])


def test_signals_keep_their_columns() -> None:
    table = window_statistics(np.array([[1.0, 10.0], [2.0, 20.0], [4.0, 40.0]]), 3, 1)
    assert table.shape == (1, 16)
    assert table[0, 0] == pytest.approx(7 / 3, abs=1e-6)
    assert table[0, 8] == pytest.approx(70 / 3, abs=1e-6)
    assert table[0, [2, 3, 10, 11]].tolist() == [1.0, 4.0, 10.0, 40.0]


@pytest.mark.parametrize(
    ("count", "stride", "firsts"),
    [
        (4, 1, [0]),
        (5, 1, [0, 1]),
        (8, 4, [0, 4]),
        (9, 4, [0, 4, 8]),
        (1, 4, [0]),
        (7, 2, [0, 2, 4]),
    ],
)
def test_windows_begin_at_every_stride_until_all_samples_are_in_one(
    count: int, stride: int, firsts: list[int]
) -> None:
    table = window_statistics(np.arange(count, dtype=float)[:, None], 4, stride)
    assert table[:, STATISTICS.index("min")].tolist() == firsts
    assert table[-1, STATISTICS.index("max")] == count - 1


def test_the_last_window_is_filled_up_with_the_last_sample() -> None:
    table = window_statistics(np.array([0.0, 0.0, 0.0, 1.0, 5.0])[:, None], 3, 3)
    assert table[1, STATISTICS.index("mean")] == pytest.approx(11 / 3, abs=1e-6)


@given(st.lists(st.floats(-50.0, 50.0), min_size=1, max_size=40), st.integers(3, 12), st.data())
def test_every_window_is_that_of_its_samples_alone(
    values: list[float], window: int, data: st.DataObject
) -> None:
    stride = data.draw(st.integers(1, window))
    table = window_statistics(np.array(values)[:, None], window, stride)
    assert np.isfinite(table).all()
    for k, row in enumerate(table):
        part = values[k * stride : k * stride + window]
        part += part[-1:] * (window - len(part))
        alone = window_statistics(np.array(part)[:, None], window, 1)[0]
        np.testing.assert_allclose(row, alone, rtol=1e-9, atol=1e-6)


def test_signals_are_in_the_vehicles_own_frame() -> None:
    found = signals(Motion.steady(0.0, 0.0, steps=21, speed=4.0, yaw=2.0))
    assert len(found["speed"]) == 11
    for name, value in {"speed": 4.0, "vx": 4.0, "vy": 0.0, "ax": 0.0, "yaw": 2.0}.items():
        np.testing.assert_allclose(found[name], value, atol=1e-9)


def test_a_vehicle_that_slides_has_lateral_motion() -> None:
    t = 0.05 * np.arange(41)
    found = signals(Motion.along(0.0 * t, 0.5 * t**2, yaw=0.0))
    np.testing.assert_allclose(found["vx"][2:-2], 0.0, atol=1e-9)
    np.testing.assert_allclose(found["vy"][2:-2], 0.1 * np.arange(21)[2:-2], atol=1e-9)
    np.testing.assert_allclose(found["ay"][2:-2], 1.0, atol=1e-9)


@pytest.mark.parametrize(("change", "sign"), [(0.5, 1.0), (-0.5, -1.0)])
def test_the_acceleration_is_negative_while_the_speed_falls(change: float, sign: float) -> None:
    t = 0.05 * np.arange(41)
    found = signals(Motion.along(5.0 * t + change * t**2, 0.0))
    np.testing.assert_allclose(found["acceleration"][2:-2], sign, atol=1e-9)


def test_the_yaw_does_not_jump_at_half_a_turn() -> None:
    t = 0.05 * np.arange(41)
    wrapped = (3.0 + 0.5 * t + np.pi) % (2.0 * np.pi) - np.pi
    found = signals(Motion.along(t, 0.0, yaw=wrapped))
    np.testing.assert_allclose(found["yaw"], 3.0 + 0.05 * np.arange(21), atol=1e-9)


def test_only_the_egos_part_is_sampled() -> None:
    motion = Motion.steady(0.0, 0.0, steps=41, speed=1.0)
    assert len(signals(motion, start_time=0.5, end_step=30)["speed"]) == 11
    assert len(signals(motion, start_time=2.0)["speed"]) == 1


@pytest.mark.parametrize("sample", [0.05, 0.07, 0.1, 0.25])
def test_samples_are_interpolated_in_between(sample: float) -> None:
    t = 0.05 * np.arange(41)
    speed = signals(Motion.along(0.5 * t**2, 0.0), sample)["speed"]
    inner = slice(2, len(speed) - 2)
    np.testing.assert_allclose(speed[inner], (sample * np.arange(len(speed)))[inner], atol=1e-9)
    assert len(speed) == int(2.0 / sample + 1e-6) + 1
