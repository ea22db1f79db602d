"""Distance, time and speed of a drive."""

from __future__ import annotations

from drivora_service.metrics.measured import Combine, Measured
from drivora_service.observations.run_view import RunView
from drivora_service.oracles.blocked import standing_clock


def measure_travel(run: RunView) -> tuple[Measured, ...]:
    """Measures the distance driven, the time taken, the mean speed and the longest standstill.

    A standstill at a signal that is not green does not count, as for the oracle ``blocked``.
    """
    distance = [float(ego.moved.sum()) if ego.count else None for ego in run.egos]
    duration = [ego.duration if ego.count else None for ego in run.egos]
    speed = [
        way / time if way is not None and time else None
        for way, time in zip(distance, duration, strict=True)
    ]
    standing = [float(standing_clock(ego).max()) if ego.count else None for ego in run.egos]
    return (
        Measured(name="distance_m", values=tuple(distance), combine=Combine.MEAN),
        Measured(name="duration_s", values=tuple(duration), combine=Combine.MOST),
        Measured(name="mean_speed_mps", values=tuple(speed), combine=Combine.MEAN),
        Measured(name="standing_time_s", values=tuple(standing), combine=Combine.MOST),
    )
