"""Results for the tests."""

from __future__ import annotations

from benchmarks.suite.result import (
    Better,
    Machine,
    PackageVersion,
    Quantity,
    Section,
    Series,
    SuiteResult,
)

MACHINE = Machine(
    cpu="A processor",
    cores=2,
    memory_gb=8.0,
    system="Linux 6.1 x86_64",
    python="3.11.7",
    load=(0.5, 0.4, 0.3),
    nice=0,
    commit="abc",
    packages=(PackageVersion(package="libsumo", version="1.28.0"),),
)


def series(
    name: str, *values: float, case: str = "a town", better: Better = Better.LOWER, unit: str = ""
) -> Series:
    quantity = Quantity(case=case, name=name, unit=unit, better=better)
    return Series(quantity=quantity, values=values)


def result(
    *measured: Series,
    machine: Machine = MACHINE,
    short: bool = False,
    remarks: tuple[str, ...] = (),
) -> SuiteResult:
    section = Section(
        name="run-cost",
        title="Cost of a run",
        about="What is measured.",
        load=0.5,
        seconds=12.0,
        series=measured,
        remarks=remarks,
    )
    return SuiteResult(
        begun="2026-01-02T03:04:05+00:00",
        short=short,
        command=("--rounds", "3"),
        machine=machine,
        sections=(section,),
    )
