"""Savitzky-Golay filters: SciPy's values, for any window."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from drivora_service.observations.local_polynomials import slopes, smooth


@pytest.mark.parametrize("window", [3, 4, 5, 8, 15, 16, 38])
def test_filters_are_those_of_scipy(window: int) -> None:
    signals = np.random.default_rng(window).normal(size=(3, 60))
    for found, deriv in ((smooth(signals, window), 0), (slopes(signals, window, 0.05), 1)):
        expected = signal.savgol_filter(signals, window, 2, deriv=deriv, delta=0.05)
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-11)


def test_a_window_of_all_samples_is_one_parabola() -> None:
    signals = np.random.default_rng(1).normal(size=(2, 9))
    expected = signal.savgol_filter(signals, 9, 2)
    np.testing.assert_allclose(smooth(signals, 9), expected, rtol=0.0, atol=1e-12)


def test_parabolas_are_kept() -> None:
    time = 0.1 * np.arange(40)
    signals = np.stack((2.0 - time + 3.0 * time**2, 5.0 * time))
    np.testing.assert_allclose(smooth(signals, 7), signals, atol=1e-11)
    np.testing.assert_allclose(slopes(signals, 7, 0.1)[0], 6.0 * time - 1.0, atol=1e-10)
