"""The filter gives what SciPy's gives."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import savgol_filter

from drivora_service.observations.savitzky_golay import savitzky_golay


@pytest.mark.parametrize("window", [3, 4, 8, 15, 16])
@pytest.mark.parametrize("derivative", [0, 1, 2])
@pytest.mark.parametrize("count", [16, 17, 300])
def test_agrees_with_scipy(window: int, derivative: int, count: int) -> None:
    samples = np.random.default_rng(window).normal(size=(3, count)).cumsum(axis=1)
    wanted = savgol_filter(samples, window, 2, deriv=derivative, delta=0.05)
    found = savitzky_golay(samples, window, 2, derivative=derivative, spacing=0.05)
    assert found == pytest.approx(wanted, abs=1e-7 * np.abs(wanted).max())
