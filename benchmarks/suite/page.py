"""The page of a result."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

from benchmarks.suite.result import Section, Series, SuiteResult

_HEAD = """# Benchmarks

Written by `python -m benchmarks`, which measures all of this; by hand nothing is changed here. \
Each value is the median of the rounds, with the smallest and the largest in parentheses. Within a \
round, everything that is compared takes turns, so that ratios hold on a machine that changes its \
speed; absolute times depend on the machine. How to run it, compare two results, and what the \
result file contains: [the suite](../../benchmarks/README.md#the-suite).
"""


def page(result: SuiteResult) -> str:
    """Returns a result as a page of the documentation."""
    parts = [_HEAD, *_machine(result)]
    for section in result.sections:
        parts += _section(section)
    return "\n".join(parts)


def _machine(result: SuiteResult) -> Iterator[str]:
    machine = result.machine
    load = ", ".join(f"{one:.1f}" for one in machine.load)
    packages = ", ".join(f"{one.package} {one.version}" for one in machine.packages)
    if result.short:
        yield "**The short form, which only shows that everything runs: its values say little.**\n"
    if machine.load[0] > machine.cores:
        yield (
            f"**Other programs ran: the load was {machine.load[0]:.1f} on {machine.cores} cores. "
            "Ratios are disturbed as well.**\n"
        )
    rows = (
        ("begun", result.begun),
        ("command", f"`{' '.join(('python -m benchmarks', *result.command))}`"),
        ("commit", machine.commit or "unknown"),
        ("processor", f"{machine.cores} cores of {machine.cpu}, {machine.memory_gb:.1f} GB"),
        ("system", f"{machine.system}, Python {machine.python}"),
        ("packages", packages),
        ("load over 1, 5, 15 minutes", load),
        ("nice", str(machine.nice)),
    )
    yield "| | |\n|---|---|"
    for name, value in rows:
        yield f"| {name} | {value} |"
    yield ""


def _section(section: Section) -> Iterator[str]:
    yield f"## {section.title}\n"
    yield f"{section.about}\n"
    if section.series:
        rounds = sorted({len(series.values) for series in section.series})
        yield (
            f"`{section.name}`: {' or '.join(map(str, rounds))} "
            f"round{'' if rounds == [1] else 's'}, {section.seconds:.0f} s, load "
            f"{section.load:.1f} before.\n"
        )
        yield from _table(section)
    for remark in section.remarks:
        yield f"Left out: {remark}\n"


def _table(section: Section) -> Iterator[str]:
    """Yields a row a case where all cases have the same quantities, else a row a quantity."""
    cases = [list(series) for _, series in groupby(section.series, lambda s: s.quantity.case)]
    names = [[_name(one) for one in series] for series in cases]
    if len(cases) > 1 and all(one == names[0] for one in names) and len(names[0]) <= len(cases) + 4:
        yield f"| | {' | '.join(names[0])} |"
        yield f"|---|{'---|' * len(names[0])}"
        for series in cases:
            cells = " | ".join(_value(one) for one in series)
            yield f"| {series[0].quantity.case} | {cells} |"
    else:
        yield "| | | |\n|---|---|---|"
        for one in section.series:
            yield f"| {one.quantity.case} | {_name(one)} | {_value(one)} |"
    yield ""


def _name(series: Series) -> str:
    unit = series.quantity.unit
    return f"{series.quantity.name}, {unit}" if unit else series.quantity.name


def _value(series: Series) -> str:
    if len(series.values) == 1:
        return number(series.median)
    return f"{number(series.median)} ({number(series.low)} to {number(series.high)})"


def number(value: float) -> str:
    """Returns a number with three significant digits."""
    if value == 0.0:
        return "0"
    size = abs(value)
    decimals = 0 if size >= 99.95 else 1 if size >= 9.995 else 2 if size >= 0.1 else 3
    return f"{value:,.{decimals}f}"
