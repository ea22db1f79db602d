"""The catalogue of metrics: the built-in ones, and those of installed packages."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Mapping
from functools import partial
from typing import Any

from drivora_service.errors import PluginError
from drivora_service.metrics.installed_metrics import InstalledMetric, last_lines
from drivora_service.metrics.metric_descriptions import METRICS
from drivora_service.metrics.plugin import MetricPlugin
from drivora_service.oracles.oracle_descriptions import MeasureDescription, MeasureKind
from drivora_service.plugin_table import PluginTable

_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
_LONGEST_NAME = 60
"""Maximum length of a name, characters."""

_BUILT_IN = {metric.name: metric for metric in METRICS}
_refusal = partial(PluginError, cause="metric_plugin")


class MetricCatalogue:
    """Metrics by name.

    Packages provide them by entry points, found when the catalogue is made and loaded on first
    use. A metric that cannot be loaded is not tried again.
    """

    def __init__(self) -> None:
        self._table = PluginTable(
            kind="metric",
            group="drivora_service.metrics",
            type_=MetricPlugin,
            built_in=(),
            error=_refusal,
        )
        self._installed: dict[str, InstalledMetric | PluginError] = {}

    @property
    def installed_names(self) -> tuple[str, ...]:
        """The names of the metrics of packages, sorted."""
        return self._table.names()

    def names(self) -> tuple[str, ...]:
        """Returns all names: the built-in ones in their order, then packages' sorted."""
        return (*_BUILT_IN, *self.installed_names)

    def versions(self, name: str) -> Mapping[str, str]:
        """Returns the package of a metric with its version; empty for a built-in one."""
        return {} if name in _BUILT_IN else self._table.versions(name)

    def load_installed(self) -> tuple[InstalledMetric, ...]:
        """Returns the metrics of installed packages, sorted by name.

        Raises:
            PluginError: One of them cannot be loaded or made.
        """
        return tuple(map(self._load, self.installed_names))

    def reason(self, name: str) -> str:
        """Returns why a metric cannot be loaded, which prevents all runs; "" if it can."""
        if name in self._table.names():
            try:
                self._load(name)
            except PluginError as error:
                return str(error)
        return ""

    def descriptions(self) -> tuple[MeasureDescription, ...]:
        """Returns what each metric says about itself, without those that cannot be loaded."""
        found = list(METRICS)
        for name in self.installed_names:
            with contextlib.suppress(PluginError):
                self._load(name)
                found.append(_describe(self._table.plugin(name), self._table.package(name)))
        return tuple(found)

    def _load(self, name: str) -> InstalledMetric:
        if name not in self._installed:
            try:
                self._installed[name] = self._make(name)
            except PluginError as error:
                self._installed[name] = error
        made = self._installed[name]
        if isinstance(made, PluginError):
            # Raising the same exception again would add frames to its traceback each time.
            raise PluginError(str(made), cause=made.cause, log=made.log) from made
        return made

    def _make(self, name: str) -> InstalledMetric:
        package = self._table.package(name)
        of = f"metric {name!r} of the package {package!r}"
        try:
            plugin = self._table.plugin(name)
        except PluginError as error:
            log = "" if error.__cause__ is None else last_lines(error.__cause__)
            raise _refusal(f"{of}: {error}", log=log) from error
        if name in _BUILT_IN:
            raise _refusal(f"{of} has the name of a built-in metric; give it another")
        if not _NAME.fullmatch(name) or len(name) > _LONGEST_NAME:
            raise _refusal(
                f"{of}: allowed are names in snake case of at most {_LONGEST_NAME} characters"
            )
        try:
            metric: Any = plugin.create()
            measures = callable(getattr(metric, "measure", None))
        except (Exception, SystemExit) as error:
            raise _refusal(
                f"{of} raised {type(error).__name__} when it was made: {error}",
                log=last_lines(error),
            ) from error
        if not measures:
            raise _refusal(f"{of} is a {type(metric).__name__}, which has no method `measure`")
        return InstalledMetric(
            name=name, package=package, metric=metric, combine=plugin.several_egos
        )


def _describe(plugin: MetricPlugin, package: str) -> MeasureDescription:
    return MeasureDescription(
        name=plugin.name,
        kind=MeasureKind.METRIC,
        feedback="",
        definition=plugin.description,
        unit=plugin.unit,
        better=plugin.better,
        several_egos=plugin.several_egos.value,
        threshold="",
        source=plugin.source or package,
    )
