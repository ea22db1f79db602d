"""Writes the shipped cases of responsibility: documents, their table, and its page in the docs.

python -m tests.oracles.responsibility.writing
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from tests.oracles.responsibility.case import AT_FAULT, NOT_AT_FAULT, Case
from tests.oracles.responsibility.families import all_cases
from tests.oracles.responsibility.judged import collisions

ROOT = Path(__file__).resolve().parents[3]
FOLDER = ROOT / "openscenario_schemas" / "examples" / "responsibility"
TABLE = FOLDER / "cases.json"
PAGE = ROOT / "docs" / "reference" / "responsibility-cases.md"

_INTRODUCTION = (
    "# Cases of responsibility\n"
    "\n"
    "{count} collisions whose responsibility is known, shipped in "
    "`openscenario_schemas/examples/responsibility/` as scenarios. The egos are "
    "[`scripted`](agents/scripted.md), so that every manoeuvre is exact. `cases.json`"
    " beside them is this table. The expected verdicts were written down, each with "
    "its source, before the [rule](oracles.md#collision) that judges them today. The "
    "last column is the answer of nuPlan's rule alone.\n"
    "\n"
    "```\n"
    "drivora run openscenario_schemas/examples/responsibility/head-on-with-wrong-way-"
    "driver.json\n"
    "```\n"
    "\n"
    "nuPlan's classes are those of its metric for collisions at fault (Karnchanachari"
    " et al. 2024); RSS's rules those of Shalev-Shwartz, Shammah, Shashua 2017; UNECE"
    " R157 is meant in its 01 series of amendments; the Vienna Convention is that on "
    "Road Traffic of 1968.\n"
    "\n"
    "| case | what happens | expected | source | nuPlan's rule |\n"
    "|---|---|---|---|---|\n"
)


def table() -> list[dict[str, Any]]:
    """The entries of ``cases.json``."""
    return [_entry(case) for case in all_cases()]


def _entry(case: Case) -> dict[str, Any]:
    entry: dict[str, Any] = {
        "name": case.name,
        "happens": case.happens,
        "expected": {case.egos[0].name: case.expected, **case.expected_of},
        "source": case.source,
        "nuplan": {ego: nuplan(case, ego) for ego in (case.egos[0].name, *case.expected_of)},
    }
    return entry


def nuplan(case: Case, ego: str) -> str:
    """What nuPlan's rule says of an ego's collision."""
    return AT_FAULT if collisions(case.name)[ego].at_fault else NOT_AT_FAULT


def table_text(entries: list[dict[str, Any]]) -> str:
    """``cases.json``."""
    return json.dumps({"cases": entries}, indent=2, ensure_ascii=False) + "\n"


def page_text(entries: list[dict[str, Any]]) -> str:
    """The page of the reference."""
    rows = "".join(
        f"| `{entry['name']}` | {entry['happens']} | {_said(entry['expected'])} "
        f"| {entry['source']} | {_said(entry['nuplan'])} |\n"
        for entry in entries
    )
    return _INTRODUCTION.format(count=len(entries)) + rows


def _said(answers: dict[str, str]) -> str:
    if len(answers) == 1:
        return next(iter(answers.values()))
    return "; ".join(f"`{ego}` {answer}" for ego, answer in answers.items())


def write() -> None:
    """Writes everything anew."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for stale in FOLDER.glob("*.json"):
        stale.unlink()
    for case in all_cases():
        (FOLDER / f"{case.name}.json").write_text(case.text())
    entries = table()
    TABLE.write_text(table_text(entries))
    PAGE.write_text(page_text(entries))


if __name__ == "__main__":
    write()
