"""Draws the pictures of the documentation anew: ``make pictures``.

Usage: ``python -m tests.docs.pictures [PART…]``; without parts, all. Pictures in the cards of
agents are drawn by ``drivora agents benchmark``, which needs each ADS installed.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from drivora_service.cli.campaigns.campaign_files import shipped_campaigns
from tests.campaigns.test_example_campaigns import DISCOVERIES
from tests.docs.page_pictures import draw_page_pictures
from tests.docs.rewrite import rewrite
from tests.docs.speed_chart import draw_speed_chart
from tests.docs.study_page import write_study_page
from tests.oracles.responsibility import writing

_ROOT = Path(__file__).resolve().parents[2]
_IMAGES = _ROOT / "docs" / "images"


def _of_pages(_: Path) -> None:
    """The pictures that the commands of the README and the tutorial draw."""
    for page in ("README.md", "docs/tutorial/first-run.md"):
        rewrite(_ROOT / page)


def _of_campaigns(folder: Path) -> None:
    """The failures that the example campaigns find."""
    for name, discovery in DISCOVERIES.items():
        found = folder / name
        file = shipped_campaigns() / f"{name}.yaml"
        _run("-m", "drivora_service.cli", "campaign", "run", file, "--out", found)
        trace = found / f"{discovery.number:06d}.trace.parquet"
        oracle = discovery.kind.partition("|")[0]
        picture = _IMAGES / f"{name}.png"
        _run("-m", "drivora_service.cli", "plot", trace, "--oracle", oracle, "--out", picture)


def _of_responsibility(_: Path) -> None:
    """Ten cases of responsibility, with their documents and their page."""
    writing.write()
    writing.draw()


def _of_avoidability(folder: Path) -> None:
    """Ten of the hundred collisions: their campaigns are run again."""
    pictures = _IMAGES / "avoidability"
    names = sorted(picture.stem for picture in pictures.glob("*.png"))
    results, traces = folder / "avoidability.jsonl", folder / "traces"
    study = ("-m", "benchmarks.avoidability")
    _run(*study, "collect", "--out", results, "--traces", traces)
    _run(*study, "draw", results, "--traces", traces, "--folder", pictures, "--names", *names)


def _of_study(folder: Path) -> None:
    """The overview and the chart of the example study, which takes long."""
    drivora = ("-m", "drivora_service.cli", "study")
    data = ("--data-dir", folder / "study")
    file = _ROOT / "openscenario_schemas" / "examples" / "studies" / "three-methods.yaml"
    _run(*drivora, "run", file, *data)
    write_study_page(folder / "study")


def _of_the_page(folder: Path) -> None:
    """Screens of the web page, and a replay as an animation."""
    draw_page_pictures(folder / "page", _IMAGES)


def _of_the_speed(_: Path) -> None:
    """The chart of the README, from the results of the benchmarks."""
    draw_speed_chart()


PARTS = {
    "pages": _of_pages,
    "campaigns": _of_campaigns,
    "responsibility": _of_responsibility,
    "avoidability": _of_avoidability,
    "study": _of_study,
    "page": _of_the_page,
    "speed": _of_the_speed,
}


def _run(*arguments: object) -> None:
    subprocess.run([sys.executable, *map(str, arguments)], check=True, cwd=_ROOT)


def main(parts: Sequence[str]) -> None:
    """Draws the pictures of parts."""
    with tempfile.TemporaryDirectory() as folder:
        for part in parts or PARTS:
            PARTS[part](Path(folder))


if __name__ == "__main__":
    main(sys.argv[1:])
