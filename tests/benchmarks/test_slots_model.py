from __future__ import annotations

from dataclasses import replace

import pytest

from benchmarks.slots.model import Model, cluster_table, fit, table
from benchmarks.slots.service import Point


def point(slots: int, kind: str, rate: float, *, own_ms: float, efficiency: float) -> Point:
    return Point(
        slots=slots,
        kind=kind,
        runs=round(10 * rate),
        seconds=10.0,
        run_s=0.08,
        own_ms=own_ms,
        efficiency=efficiency,
    )


# An owner that takes half a millisecond a run and 2 % of a core besides, and slots with 2 ms
# between two runs of 80 ms.
POINTS = tuple(
    point(slots, kind, rate, own_ms=0.5 + 20.0 / rate, efficiency=80.0 / 82.0)
    for slots, kind, rate in ((1, "real", 12.2), (2, "real", 24.4), (64, "sleeping", 780.0))
)


def test_costs_are_found_again_in_what_they_caused() -> None:
    model = fit(POINTS, run_s=0.08)
    assert model.own_s == pytest.approx(0.0005)
    assert model.fixed == pytest.approx(0.02)
    assert model.gap_s == pytest.approx(0.002)


def test_the_owner_limits_many_slots() -> None:
    model = Model(run_s=0.08, gap_s=0.0, fixed=0.02, own_s=0.0005)
    assert model.most == pytest.approx(1960.0)
    assert model.efficiency(100) == pytest.approx(1.0)
    assert model.efficiency(1000) == pytest.approx(1960.0 * 0.08 / 1000.0)
    assert "1000 slots are" in table(POINTS, model)


@pytest.mark.parametrize(("slots", "gap_s"), [(1000, 0.002), (10, 0.01)])
def test_runs_can_be_long_enough_for_any_number_of_slots(slots: int, gap_s: float) -> None:
    model = Model(run_s=0.08, gap_s=gap_s, fixed=0.02, own_s=0.0005)
    run_s = model.shortest_run_s(slots, 0.9)
    longer = Model(run_s=run_s, gap_s=gap_s, fixed=0.02, own_s=0.0005)
    assert longer.efficiency(slots) == pytest.approx(0.9)


def test_each_process_of_a_cluster_has_its_limit() -> None:
    model = fit(POINTS, run_s=0.08)
    text = cluster_table([replace(one, driver_ms=3.0 * one.own_ms) for one in POINTS], model)
    assert "The service needs 0.500 ms a run and 2.0% of a core" in text
    assert "connected with Ray needs 1.500 ms a run and 6.0% of a core" in text
    # 90 % of a thousand slots, each run of which takes 1.5 ms of 94 % of a core: 1436.2 ms. No
    # number is half way between two: which of them the fit is rounded to differs by machine.
    assert "it is full at 627 runs a second" in text
    assert "busy with runs of 1436 ms or more" in text
