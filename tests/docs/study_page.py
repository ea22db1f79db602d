"""Writes what the example study has found into its page: its overview, and its chart.

Usage: ``python -m tests.docs.study_page DATA_DIR``, with the data folder in which the study has
finished. ``python -m tests.docs.pictures study`` runs the study before, which takes long.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

_ROOT = Path(__file__).resolve().parents[2]
_PAGE = _ROOT / "docs" / "how-to" / "run-a-study.md"
_CHART = _ROOT / "docs" / "images" / "study.svg"
_BEGIN, _END = "<!-- overview: begin -->\n", "<!-- overview: end -->\n"


def write_study_page(data: Path) -> None:
    """Writes the overview and the chart of the only study in a data folder, which has finished."""
    drivora = (sys.executable, "-m", "drivora_service.cli", "study")
    listed = subprocess.check_output([*drivora, "list", "--json", "--data-dir", data])
    (study,) = json.loads(listed)
    if study["state"] != "finished":
        raise RuntimeError(f"study {study['id']} is {study['state']}; resume it first")
    with tempfile.TemporaryDirectory() as folder:
        compare = ("compare", study["id"], "--data-dir", data, "--out", folder)
        subprocess.run([*drivora, *compare], check=True)
        text = (Path(folder) / "study.md").read_text()
        shutil.copyfile(Path(folder) / "values.svg", _CHART)
    overview = "## " + text.split("\n![", maxsplit=1)[0].split("\n## ", maxsplit=1)[1]
    page = _PAGE.read_text()
    before, _, rest = page.partition(_BEGIN)
    _, end, after = rest.partition(_END)
    if not end:
        raise RuntimeError(
            f"{_PAGE} has no lines {_BEGIN!r} and {_END!r}; write them where it goes"
        )
    # A level below the page's own headings.
    overview = overview.replace("\n## ", "\n### ").replace("## ", "### ", 1).rstrip()
    chart = "![The first measure, a panel each scenario and ADS](../images/study.svg)"
    _PAGE.write_text(f"{before}{_BEGIN}{overview}\n\n{chart}\n{_END}{after}")


if __name__ == "__main__":
    write_study_page(Path(sys.argv[1]))
