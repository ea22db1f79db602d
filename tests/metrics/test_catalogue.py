from __future__ import annotations

from pathlib import Path

import pytest

from drivora_service.errors import PluginError
from drivora_service.metrics.catalogue import MetricCatalogue
from drivora_service.metrics.installed_metrics import measure_installed
from drivora_service.metrics.metric_descriptions import METRICS
from drivora_service.observations.run_view import RunView
from drivora_service.oracles.oracle_descriptions import MeasureKind
from drivora_service.testing.networks import straight_road
from drivora_service.testing.traces import Motion, SyntheticEgo, make_trace
from tests.installed_parts import PACKAGE, install_parts

CODE = """\
from dataclasses import replace
from own_parts import METRIC

class Raising:
    def measure(self, ego):
        return 1 / 0

class Answering:
    def __init__(self, answer):
        self.answer = answer

    def measure(self, ego):
        return self.answer

def fail():
    raise RuntimeError("no such file")

raising = replace(METRIC, name="raising", create=Raising)
infinite = replace(METRIC, name="infinite", create=lambda: Answering(float("nan")))
unmade = replace(METRIC, name="unmade", create=fail)
measureless = replace(METRIC, name="measureless", create=lambda: "a metric")
success = replace(METRIC, name="success")
Loud = replace(METRIC, name="Loud")
text = "a metric"
"""
BUILT_IN = tuple(metric.name for metric in METRICS)


def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *names: str) -> MetricCatalogue:
    points = [f"{name} = more_parts:{name}" for name in names]
    parts = "\n".join(
        ["[drivora_service.metrics]", "walker_speed_mps = own_parts:METRIC", *points, ""]
    )
    install_parts(tmp_path / "site", monkeypatch, parts=parts, code=CODE)
    return MetricCatalogue()


def drive() -> RunView:
    egos = [
        SyntheticEgo(id=f"ego_{k}", motion=Motion.steady(0.0, 3.5 * k, steps=20, speed=5.0))
        for k in (0, 1)
    ]
    return RunView(make_trace(egos), straight_road())


def test_without_packages_there_are_the_built_in_ones() -> None:
    catalogue = MetricCatalogue()
    assert catalogue.names() == BUILT_IN
    assert catalogue.load_installed() == ()
    assert catalogue.descriptions() == METRICS
    assert catalogue.versions("success") == {}


def test_a_metric_of_a_package_follows_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    catalogue = installed(tmp_path, monkeypatch)
    assert catalogue.names() == (*BUILT_IN, "walker_speed_mps")
    assert catalogue.versions("walker_speed_mps") == {PACKAGE: "0.1"}
    told = catalogue.descriptions()[-1]
    assert (told.name, told.kind, told.unit) == ("walker_speed_mps", MeasureKind.METRIC, "m/s")
    assert (told.several_egos, told.source) == ("most", PACKAGE)
    values = measure_installed(catalogue.load_installed(), drive())
    assert values == {
        "walker_speed_mps": None,
        "walker_speed_mps[ego_0]": None,
        "walker_speed_mps[ego_1]": None,
    }


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("unmade", "raised RuntimeError when it was made: no such file"),
        ("measureless", "is a str, which has no method `measure`"),
        ("success", "has the name of a built-in metric"),
        ("Loud", "names in snake case of at most 60"),
        ("text", "is a str; allowed: MetricPlugin"),
        ("gone", "cannot be loaded: AttributeError"),
    ],
)
def test_a_metric_that_cannot_be_used_is_named_with_its_package(
    name: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    catalogue = installed(tmp_path, monkeypatch, name)
    for _ in range(2):
        with pytest.raises(PluginError, match=message) as told:
            catalogue.load_installed()
        assert f"metric {name!r} of the package {PACKAGE!r}" in str(told.value)
        assert told.value.cause == "metric_plugin"
    assert catalogue.reason(name) == str(told.value)
    assert catalogue.reason("walker_speed_mps") == ""
    assert [one.name for one in catalogue.descriptions()][len(BUILT_IN) :] == ["walker_speed_mps"]


@pytest.mark.parametrize(
    ("name", "cause", "message"),
    [
        ("raising", "metric_raised", "raised ZeroDivisionError: division by zero"),
        ("infinite", "metric_invalid_value", "answered 'nan' for ego 'ego_0'; allowed: a finite"),
    ],
)
def test_a_metric_that_fails_is_named_with_its_package(
    name: str, cause: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    metrics = installed(tmp_path, monkeypatch, name).load_installed()
    with pytest.raises(PluginError, match=message) as told:
        measure_installed(metrics, drive())
    assert told.value.cause == cause
    assert f"metric {name!r} of the package {PACKAGE!r}" in str(told.value)
