"""The table of faults: one row each, over all its trials."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import pytest

HEAD = """# Fault matrix

Each row injects a fault while a real service with two workers does a batch. Lost: runs without an
end. Twice: runs counted more than once. Blamed: runs of good agents that ended otherwise than
undisturbed. Back: trials after which the service finished all work and was ready by itself.
Measured by `make test-faults`.

| fault | trials | passed | lost | twice | blamed | back by itself |
|---|---|---|---|---|---|---|
"""


def table(reports: Sequence[pytest.TestReport]) -> str:
    """Returns the table in Markdown."""
    rows: dict[str, list[pytest.TestReport]] = defaultdict(list)
    for report in reports:
        if not report.skipped:
            rows[_row(report.nodeid)].append(report)
    return HEAD + "".join(_line(name, rows[name]) for name in sorted(rows))


def _row(nodeid: str) -> str:
    """Returns the name of a test without the number of its trial."""
    file, _, test = nodeid.partition("::")
    name, _, parameters = test.partition("[")
    kept = [part for part in parameters.rstrip("]").split("-") if not part.isdigit()]
    place = file.rpartition("/")[2].removeprefix("test_").removesuffix(".py")
    words = name.removeprefix("test_").replace("_", " ")
    return f"{place.replace('_', ' ')}: {words}" + (f" ({' '.join(kept)})" if any(kept) else "")


def _line(name: str, trials: Sequence[pytest.TestReport]) -> str:
    def total(name: str) -> int:
        told = [value for report in trials for key, value in report.user_properties if key == name]
        return sum(value for value in told if isinstance(value, int))

    lost, twice, blamed = total("lost"), total("twice"), total("blamed")
    back = 0
    for report in trials:
        told = [value for key, value in report.user_properties if key == "back"]
        back += bool(told) and all(told)
    passed = sum(report.passed for report in trials)
    count = len(trials)
    return f"| {name} | {count} | {passed} | {lost} | {twice} | {blamed} | {back} of {count} |\n"
