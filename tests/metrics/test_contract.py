"""A metric of a package keeps the contract, and the contract finds those that do not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from drivora_service.errors import PluginError
from drivora_service.metrics.plugin import MetricPlugin
from drivora_service.observations.run_view import EgoView
from drivora_service.testing.metric_contract import MetricContract
from tests.own_parts import METRIC


@dataclass(frozen=True)
class Made:
    formula: Callable[[EgoView], Any]

    def measure(self, ego: EgoView) -> Any:
        return self.formula(ego)


def made(formula: Callable[[EgoView], Any], **changes: Any) -> type[MetricContract]:
    metric = MetricPlugin(
        name="top_speed_mps", description="The top speed.", create=lambda: Made(formula)
    )

    class Suite(MetricContract):
        plugin = replace(metric, **changes)

    return Suite


class TestTopSpeed(made(lambda ego: float(ego.speed.max()))):  # type: ignore[misc]  # made here
    pass


class TestNumbersOfNumpy(made(lambda ego: np.float32(ego.speed.max()))):  # type: ignore[misc]  # made here
    pass


class TestWalkerSpeed(MetricContract):
    plugin = METRIC


WRONG: dict[str, tuple[type[MetricContract], str, type[BaseException]]] = {
    "constant": (made(lambda _: 1.0), "test_it_tells_the_example_runs_apart", AssertionError),
    "infinite": (
        made(lambda _: float("inf")),
        "test_every_ego_gets_a_finite_number_or_none",
        PluginError,
    ),
    "text": (made(lambda _: "3"), "test_every_ego_gets_a_finite_number_or_none", PluginError),
    "truth": (made(lambda _: True), "test_every_ego_gets_a_finite_number_or_none", PluginError),
    "a built-in name": (
        made(lambda _: 1.0, name="success"),
        "test_its_name_is_not_that_of_a_built_in_metric",
        AssertionError,
    ),
    "beyond the end": (
        made(lambda ego: float(np.abs(ego.trace.states[:, ego.row]).max())),
        "test_what_happens_after_an_egos_end_changes_nothing",
        AssertionError,
    ),
}


@pytest.mark.parametrize("mistake", WRONG)
def test_the_contract_finds_a_mistake(mistake: str) -> None:
    suite, test, error = WRONG[mistake]
    with pytest.raises(error):
        getattr(suite(), test)()
