"""Which node of a cluster gets which run, and what becomes of those of a lost node."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

import pytest

from drivora_service.execution.ray.placement import Placement
from drivora_service.execution.ray.ray_messages import News
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus


def placed(placement: Placement) -> dict[str, list[str]]:
    return {
        name: [spec.run_id for spec in orders.submit] for name, orders in placement.orders().items()
    }


def with_runs(count: int, **slots: int) -> Placement:
    placement = Placement()
    for name, number in slots.items():
        placement.join(name, number)
    for number in range(count):
        placement.submit(RunSpec(run_id=f"{number:02}", document=""))
    return placement


def finished(*run_ids: str, fault: str = "", seconds: float = 20.0) -> News:
    now = datetime.now(UTC)
    ends = tuple(
        AttemptEnd(
            report=RunReport(run_id=run_id, status=RunStatus.FINISHED),
            worker="slot",
            started=now,
            ended=now + timedelta(seconds=seconds),
        )
        for run_id in run_ids
    )
    return News(ends=ends, slots=(), fault=fault)


def statuses(ends: tuple[AttemptEnd, ...]) -> dict[str, RunStatus]:
    return {end.report.run_id: end.report.status for end in ends}


def test_nodes_get_runs_by_their_slots_in_order() -> None:
    placement = with_runs(9, small=1, large=3)
    orders = placed(placement)
    assert [len(orders[name]) for name in ("small", "large")] == [3, 6]
    assert all(run_ids == sorted(run_ids) for run_ids in orders.values())
    assert placed(placement) == {}


def test_few_runs_wait_on_nodes_and_the_others_go_to_nodes_that_join() -> None:
    placement = with_runs(100, one=2)
    assert len(placed(placement)["one"]) == 6
    placement.join("two", 2)
    assert placed(placement) == {"two": [f"{number:02}" for number in range(6, 12)]}
    assert len(placement.note("one", finished("00", "03"))) == 2
    assert placed(placement) == {"one": ["12", "13"]}


def test_a_node_is_given_more_runs_if_they_are_short() -> None:
    placement = with_runs(100, one=1)
    assert len(placed(placement)["one"]) == 4
    placement.note("one", finished("00", seconds=0.1))
    assert len(placed(placement)["one"]) == 8


def test_a_lost_node_costs_the_runs_that_it_may_have_performed() -> None:
    placement = with_runs(6, lost=2)
    placed(placement)
    placement.note("lost", finished("00"))
    failures = {
        end.report.run_id: end.report.failure for end in placement.lose("lost", "it is gone")
    }
    causes = {run_id: failure and failure.cause for run_id, failure in failures.items()}
    lost, not_begun = dict.fromkeys(("01", "02"), "worker_lost"), ("03", "04", "05")
    # Those are other attempts on another node, as a node that was cut off may begin them yet.
    assert causes == lost | dict.fromkeys(not_begun, "not_begun")
    assert all("it is gone" in failure.message for failure in failures.values() if failure)
    # What it reports too late is not counted a second time.
    assert placement.note("lost", finished("01")) == ()
    assert placement.lose("lost", "again") == ()
    placement.join("other", 2)
    assert placed(placement) == {}


def test_a_cancelled_run_of_a_lost_node_is_cancelled() -> None:
    placement = with_runs(3, lost=1)
    placed(placement)
    for run_id in ("00", "02"):
        assert placement.cancel(run_id) == ()
    assert placement.orders()["lost"].cancel == ("00", "02")
    ends = statuses(placement.lose("lost", "it is gone"))
    cancelled = dict.fromkeys(("00", "02"), RunStatus.CANCELLED)
    assert ends == {"01": RunStatus.INFRASTRUCTURE_FAILED, **cancelled}


def test_a_node_whose_workers_cannot_start_gives_its_runs_back() -> None:
    placement = with_runs(3, faulty=1)
    placed(placement)
    placement.join("sound", 1)
    placement.note("faulty", finished(fault="no library"))
    assert placement.orders()["faulty"].withdraw
    assert placement.orders() == {}
    assert placement.put_back("faulty", ["01", "02", "unknown"]) == ()
    assert placed(placement) == {"sound": ["01", "02"]}
    placement.submit(RunSpec(run_id="03", document=""))
    placement.note("faulty", finished("00"))
    assert placed(placement) == {"faulty": ["03"]}


@pytest.mark.parametrize("is_held", [True, False])
def test_withdrawn_runs_are_given_to_no_other_node(is_held: bool) -> None:
    placement = with_runs(4, one=2)
    placed(placement)
    placement.join("two", 2)
    placement.is_held = is_held
    placement.withdraw()
    assert placement.orders()["one"].withdraw
    placement.put_back("one", ["02", "03"])
    assert not placement.is_withdrawing
    assert bool(placed(placement)) is not is_held
    assert placement.take_waiting() == (("02", "03") if is_held else ())
