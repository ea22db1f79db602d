"""A metric of an installed package, whose values are checked."""

from __future__ import annotations

import math
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from drivora_service.errors import PluginError
from drivora_service.metrics.measured import Combine, Measured
from drivora_service.metrics.plugin import Metric

if TYPE_CHECKING:
    from drivora_service.observations.run_view import EgoView, RunView

_LOG = 4000
"""Maximum length of a kept traceback, characters."""


@dataclass(frozen=True, slots=True, kw_only=True)
class InstalledMetric:
    """Wraps the metric of a package; its errors name the metric and the package.

    Attributes:
        name: Name of the metric.
        package: Name of its package.
        metric: The metric.
        combine: How the values of several egos become that of the run.
    """

    name: str
    package: str
    metric: Metric
    combine: Combine

    def measure(self, run: RunView) -> Measured:
        """Measures all egos of a run; those without a row are not measurable.

        Raises:
            PluginError: The metric raised, or its answer is no finite number and not ``None``.
        """
        values = tuple(self._value(ego) if ego.count else None for ego in run.egos)
        return Measured(name=self.name, values=values, combine=self.combine)

    def _value(self, ego: EgoView) -> float | None:
        of = f"metric {self.name!r} of the package {self.package!r}"
        try:
            answer: Any = self.metric.measure(ego)
            # Numbers of NumPy become Python's own, as reports are passed between processes.
            value = None if answer is None or isinstance(answer, bool | str) else float(answer)
        except (Exception, SystemExit) as error:
            raise PluginError(
                f"{of} raised {type(error).__name__}: {error}",
                cause="metric_raised",
                log=last_lines(error),
            ) from error
        if answer is not None and (value is None or not math.isfinite(value)):
            raise PluginError(
                f"{of} answered {str(answer)[:80]!r} for ego {ego.id!r}; allowed: a finite "
                "number, or None where it is not measurable",
                cause="metric_invalid_value",
            )
        return value


def measure_installed(metrics: Sequence[InstalledMetric], run: RunView) -> dict[str, float | None]:
    """Measures a run by the metrics of packages.

    Returns:
        Values by name, as those of the built-in metrics.

    Raises:
        PluginError: As :meth:`InstalledMetric.measure`.
    """
    values: dict[str, float | None] = {}
    for metric in metrics:
        measured = metric.measure(run)
        values[measured.name] = measured.total
        if len(run.egos) > 1:
            for ego, value in zip(run.egos, measured.values, strict=True):
                values[f"{measured.name}[{ego.id}]"] = value
    return values


def last_lines(error: BaseException) -> str:
    """Returns the end of an error's traceback."""
    return "".join(traceback.format_exception(error))[-_LOG:]
