"""What a replay costs the browser: script a frame, and the time to the first frame.

A real service makes the runs and serves the page to the browser of the page's tests.

    python -m benchmarks.replay --out benchmarks/results/replay.md
"""

from __future__ import annotations

import argparse
import os
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict

from benchmarks.page import WEB
from benchmarks.scenes import crowd_scene
from drivora_service.cli.application.service_process import run_service
from drivora_service.client import Client
from drivora_service.dashboard.build import node_program
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.exporting import to_document
from drivora_service.scenario.model import Scenario

_CROWD = 200
_CROWD_SECONDS = 100.0
_USUAL = 20
_USUAL_SECONDS = 60.0
_AIM_SCRIPT_MS = 8.0
_AIM_FIRST_MS = 500.0


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid")


class Played(_Strict):
    """A replay that was played.

    Attributes:
        seconds: How long.
        wall: Milliseconds of script of each frame, by the clock.
        cpu: The same, of processor time.
    """

    seconds: float
    wall: list[float]
    cpu: list[float]


class Measured(_Strict):
    """What the browser measured.

    Attributes:
        first: Milliseconds from the begin of a navigation to the first frame with actors.
        from_list: The same from a click in the list of runs.
        whole: The crowd, its whole way in view.
        followed: The crowd, following the ego, with the trails of the whole run.
    """

    first: list[float]
    from_list: list[float]
    whole: Played
    followed: Played


def scenes() -> tuple[Scenario, Scenario]:
    """Returns a scene with very many actors and one of the usual size."""
    highway = NetworkCatalogue(shipped_networks()).get("highway")
    return (
        crowd_scene(highway, npcs=_CROWD - 1, seconds=_CROWD_SECONDS),
        crowd_scene(highway, npcs=_USUAL - 1, seconds=_USUAL_SECONDS),
    )


def measure(url: str, *, seconds: float, rounds: int) -> tuple[Measured, tuple[int, int]]:
    """Returns what the browser measured, and the numbers of steps of both runs."""
    with Client(url) as client:
        documents = [document_text(to_document(scene)) for scene in scenes()]
        batch = client.post_batch(documents, name="replays").batch
        runs = sorted(client.wait_for_batch(batch.id), key=lambda run: run.item)
    crowd, usual = runs
    script = "browser/measureReplay.ts"
    done = subprocess.run(
        [str(node_program()), script, url, crowd.id, usual.id, str(seconds), str(rounds)],
        cwd=WEB,
        stdout=subprocess.PIPE,
        check=True,
        text=True,
    )
    return Measured.model_validate_json(done.stdout), (crowd.steps or 0, usual.steps or 0)


def page(measured: Measured, *, steps: tuple[int, int], load: float) -> str:
    """Returns the results as a page of Markdown."""
    crowd_steps, usual_steps = steps
    return "\n".join(
        [
            "# Replays in the browser",
            "",
            "`python -m benchmarks.replay`: a real service with one worker, Chromium without a "
            f"graphics card; {os.cpu_count()} cores for all of them, load average {load:.1f} "
            "before. Milliseconds.",
            "",
            f"Script of a frame, {_CROWD} actors, {crowd_steps:,} steps on `highway` (aim: 95 % "
            f"below {_AIM_SCRIPT_MS:.0f}): all that runs in the page's thread from one frame to "
            "the next. WebGL draws by software here, which limits the frames a second.",
            "",
            "| | processor time: median | 95 % below | by the clock: median | 95 % below "
            "| frames | a second |",
            "|---|---|---|---|---|---|---|",
            _script_row("the ego's whole way in view", measured.whole),
            _script_row("following the ego, trails of the whole run", measured.followed),
            "",
            f"Time to the first frame with actors, {_USUAL} actors, {usual_steps:,} steps (aim: "
            f"{_AIM_FIRST_MS:.0f} from the list).",
            "",
            "| | rounds | median | smallest | largest |",
            "|---|---|---|---|---|",
            _first_row("after a click in the list of runs", measured.from_list),
            _first_row("by a new window, with all code of the page", measured.first),
            "",
        ]
    )


def _script_row(name: str, played: Played) -> str:
    cells = [
        f"{np.percentile(values, share):.1f}"
        for values in (played.cpu, played.wall)
        for share in (50, 95)
    ]
    frames = len(played.wall)
    return f"| {name} | {' | '.join(cells)} | {frames} | {frames / played.seconds:.1f} |"


def _first_row(name: str, values: Sequence[float]) -> str:
    return (
        f"| {name} | {len(values)} | {np.median(values):.0f} | {min(values):.0f} "
        f"| {max(values):.0f} |"
    )


def main() -> None:
    """Measures, and writes the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seconds", type=float, default=12.0, help="playing of each")
    parser.add_argument("--rounds", type=int, default=5, help="openings of a run")
    parser.add_argument("--out", type=Path)
    given = parser.parse_args()
    load = os.getloadavg()[0]
    with (
        tempfile.TemporaryDirectory() as folder,
        run_service(Path(folder), workers=1) as url,
    ):
        measured, steps = measure(url, seconds=given.seconds, rounds=given.rounds)
    written = page(measured, steps=steps, load=load)
    if given.out:
        given.out.write_text(written)
    print(written)


if __name__ == "__main__":
    main()
