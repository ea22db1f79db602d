from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from benchmarks.suite.machine import this_machine
from benchmarks.suite.measurement import Measurement, Plan, Round, Sample, perform, sample


def test_rounds_are_performed_between_opening_and_closing(tmp_path: Path) -> None:
    done: list[str] = []

    @contextmanager
    def opened(plan: Plan) -> Iterator[Round]:
        done.append("open")
        plan.remarks.append("something.")

        def once() -> Iterator[Sample]:
            done.append("round")
            yield sample("case", "first", len(done), "ms")
            yield sample("case", "second", 10.0 * len(done), "ms")

        yield once
        done.append("close")

    plan = Plan(
        short=True,
        rounds=3,
        simulations=50,
        networks=None,
        routes=None,
        cache=tmp_path,
        folder=tmp_path,
    )
    section = perform(Measurement(name="m", title="M", about="It.", open=opened), plan)
    assert done == ["open", "round", "round", "round", "close"]
    assert [(one.quantity.name, one.values) for one in section.series] == [
        ("first", (2.0, 3.0, 4.0)),
        ("second", (20.0, 30.0, 40.0)),
    ]
    assert section.remarks == ("something.",)


def test_the_machine_is_described() -> None:
    machine = this_machine()
    assert machine.cpu
    assert machine.cores >= 1
    assert {"drivora", "libsumo"} <= {one.package for one in machine.packages}
