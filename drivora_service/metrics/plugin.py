"""The plug-in by which a package registers a metric."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from drivora_service.metrics.measured import Combine
from drivora_service.oracles.oracle_descriptions import SHARE, Better

if TYPE_CHECKING:
    # Code that only lists metrics must not load the dependencies of measuring.
    from drivora_service.observations.run_view import EgoView


class Metric(Protocol):
    """Measures egos. Frozen dataclasses whose fields are the thresholds implement it.

    Measuring is a pure function of the run: the same run gives the same value in every worker.
    """

    def measure(self, ego: EgoView) -> float | None:
        """Returns the value of an ego that has at least one row; ``None`` if not measurable."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class MetricPlugin:
    """The object that an entry point of the group ``drivora_service.metrics`` names.

    Attributes:
        name: In snake case, at most 60 characters, with the unit as its end: ``least_gap_m``.
        description: One sentence.
        create: Factory of the metric, called once in each process.
        unit: Unit of the value; `1` for a share or a score.
        better: Direction in which it is better for the ADS; a search goes the other way.
        several_egos: How the values of several egos become that of the run.
        source: Where the formula comes from; "" for the package.
    """

    name: str
    description: str
    create: Callable[[], Metric]
    unit: str = SHARE
    better: Better = Better.NEITHER
    several_egos: Combine = Combine.MEAN
    source: str = ""
