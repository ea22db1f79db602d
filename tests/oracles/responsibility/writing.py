"""Writes the shipped cases of responsibility: documents, their table, its page and pictures.

python -m tests.oracles.responsibility.writing
"""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import Any

from drivora_service.cli.terminal.trace_drawing import draw_trace
from drivora_service.observations.trace_files.trace_file import write_trace
from drivora_service.settings import Settings
from tests.oracles.responsibility.case import AT_FAULT, NOT_AT_FAULT, Case
from tests.oracles.responsibility.families import all_cases
from tests.oracles.responsibility.judged import collisions, recorded

ROOT = Path(__file__).resolve().parents[3]
FOLDER = ROOT / "openscenario_schemas" / "examples" / "responsibility"
PICTURES = ROOT / "docs" / "images" / "responsibility"
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


PICTURED = (
    "other-cuts-in-short",
    "ego-cuts-in-and-stops",
    "head-on-with-wrong-way-driver",
    "ego-stops-in-oncoming-lane",
    "ego-evades-wrong-way-driver-who-returns",
    "ego-veers-into-oncoming-in-junction",
    "ego-turns-left-before-oncoming",
    "ego-runs-red-and-is-hit",
    "ego-enters-roundabout-before-circulating-vehicle",
    "walker-steps-out",
)
"""Cases of which the page shows a strip of moments."""


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
    return AT_FAULT if collisions(case.name)[ego].evidence["nuplan_at_fault"] else NOT_AT_FAULT


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
    shown = "".join(
        f"\n### {name}\n{entry['happens']} Expected: {_said(entry['expected'])}; nuPlan's rule: "
        f"{_said(entry['nuplan'])}.\n\n![{entry['happens']}](../images/responsibility/{name}.png)\n"
        for name in PICTURED
        for entry in entries
        if entry["name"] == name
    )
    return _INTRODUCTION.format(count=len(entries)) + rows + _PICTURES + shown


def _said(answers: dict[str, str]) -> str:
    if len(answers) == 1:
        return next(iter(answers.values()))
    return "; ".join(f"`{ego}` {answer}" for ego, answer in answers.items())


_PICTURES = """
## Ten of them
Three moments each, the last of them the collision, as `drivora plot TRACE --moments 3 --oracle
collision` draws them.
"""


def draw() -> None:
    """Draws the pictures of the page anew."""
    settings = Settings()
    for case in all_cases():
        if case.name in PICTURED:
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / f"{case.name}.trace.parquet"
                write_trace(recorded(case), path)
                target = PICTURES / f"{case.name}.png"
                draw_trace(path, settings, target, oracles=("collision",), moments=3)


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
    draw()
