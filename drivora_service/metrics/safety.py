"""Safety surrogates: how close an ego came to a collision."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.metrics.measured import Combine, Measured
from drivora_service.observations.run_view import EgoView, RunView

_Measure = Callable[[EgoView], float | None]


def measure_safety(run: RunView) -> tuple[Measured, ...]:
    """Measures gaps, times and decelerations; ``None`` without other actors.

    Times are also ``None`` if no actor was on a collision course, or no paths crossed, within the
    horizons of ``observations.proximity``. Decelerations are the largest before the boxes touch.
    """
    return (
        _measure_egos("min_gap_m", run, _min_gap, Combine.LEAST),
        _measure_egos("min_time_to_collision_s", run, _min_time, Combine.LEAST),
        _measure_egos("post_encroachment_time_s", run, _encroachment, Combine.LEAST),
        _measure_egos("max_drac_mps2", run, _drac, Combine.MOST),
        _measure_egos("max_required_deceleration_mps2", run, _required_deceleration, Combine.MOST),
        _measure_egos("rss_violation_share", run, _rss_share, Combine.MEAN),
    )


def _measure_egos(name: str, run: RunView, measure: _Measure, combine: Combine) -> Measured:
    values = tuple(
        measure(ego) if ego.count and ego.proximity.min_gap is not None else None
        for ego in run.egos
    )
    return Measured(name=name, values=values, combine=combine)


def _min_gap(ego: EgoView) -> float | None:
    return ego.proximity.min_gap


def _min_time(ego: EgoView) -> float | None:
    return _finite(float(ego.proximity.time_to_collision.min()))


def _encroachment(ego: EgoView) -> float | None:
    return ego.proximity.post_encroachment_time


def _drac(ego: EgoView) -> float | None:
    return _largest(ego.proximity.drac)


def _required_deceleration(ego: EgoView) -> float | None:
    return _largest(ego.proximity.required_deceleration)


def _rss_share(ego: EgoView) -> float | None:
    return float(ego.proximity.rss_violated.mean())


def _largest(values: FloatArray) -> float | None:
    finite = values[np.isfinite(values)]
    return float(finite.max()) if len(finite) else None


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
