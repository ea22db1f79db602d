"""The numbers of avoidable collisions of campaigns.

Random campaigns are drawn on two scenes with frequent failures, for three ADSs; each collision is a
line of the results: what the verdict says of it, and where its scenario came from.

    python -m benchmarks.avoidability collect --out benchmarks/results/avoidability.jsonl
    python -m benchmarks.avoidability show benchmarks/results/avoidability.jsonl

After a change of the oracles alone, `judge` judges the stored traces again. After a change of the
simulation, of an ADS or of the spaces, the scenarios run differently: `collect` into a new file.
"""

from __future__ import annotations

import argparse
import itertools
import json
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.search_scenes import FREQUENT, Scene, catalogues, prepare_scene, scenes_of
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Trace
from drivora_service.observations.trace_files.trace_file import read_trace
from drivora_service.oracles.avoidability.assess import assess
from drivora_service.oracles.collision import Collision
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.plotting.strip import draw_strip
from drivora_service.runs.run_report import RunReport, RunSpec
from drivora_service.worker.performing import perform
from drivora_service.worker.setup import WorkerSetup

SIMULATIONS = 300
"""Simulations of a campaign; further collisions come from campaigns with further seeds."""

MANY = {"vehicles": 8, "walkers": 2, "weather": False}
"""The space on the wet arterial: larger than in the study, where few runs collide."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """The collisions of one ADS on one scene.

    Attributes:
        wanted: Collisions that are enough.
        seed: Of the first campaign; every ADS meets scenarios of its own.
    """

    agent: str
    scene: str
    wanted: int
    seed: int

    @property
    def name(self) -> str:
        """Its name in the results."""
        return f"{self.agent}, {self.scene}"


PARTS = (
    Part(agent="idm", scene="wet arterial", wanted=20, seed=1),
    Part(agent="idm", scene="motorway in rain", wanted=20, seed=1),
    Part(agent="pdm-closed", scene="wet arterial", wanted=15, seed=101),
    Part(agent="pdm-closed", scene="motorway in rain", wanted=15, seed=101),
    Part(agent="ad-mlp", scene="wet arterial", wanted=15, seed=201),
    Part(agent="ad-mlp", scene="motorway in rain", wanted=15, seed=201),
)


def scenes(agent: str) -> dict[str, Scene]:
    """Returns the scenes of an ADS by name."""
    known = {scene.name: scene for scene in scenes_of(FREQUENT, agent)}
    return {**known, "wet arterial": replace(known["wet arterial"], space=MANY)}


def candidates(part: Part, repetition: int) -> Iterator[tuple[int, str]]:
    """Yields numbers and documents of the candidates that a random campaign draws."""
    scene = scenes(part.agent)[part.scene]
    (only,) = prepare_scene(scene, seed=repetition, simulations=SIMULATIONS).parts
    for number in range(SIMULATIONS):
        (proposal,) = only.tester.ask(1)
        candidate = only.candidates.prepare(proposal.values)
        if not candidate.problem:
            yield number, candidate.document


def collect(options: argparse.Namespace) -> None:
    """Runs campaigns until there are enough collisions of each part; resumes earlier results."""
    for part in PARTS:
        if options.agents and part.agent not in options.agents:
            continue
        lines = list(_lines(options.out)) if options.out.exists() else []
        mine = [line for line in lines if line["part"] == part.name]
        found = len(mine)
        done = max(((line["repetition"], line["number"]) for line in mine), default=(0, 0))
        for repetition in itertools.count(max(done[0], part.seed)):
            if found >= part.wanted:
                break
            for number, document in candidates(part, repetition):
                if (repetition, number) <= done:
                    continue
                if found >= part.wanted:
                    break
                for line in collide(part, repetition, number, document, options.traces):
                    found += 1
                    with options.out.open("a") as file:
                        file.write(json.dumps(line) + "\n")
                    print(part.name, repetition, number, found, line["message"], flush=True)


def collide(
    part: Part, repetition: int, number: int, document: str, traces: Path
) -> Iterator[dict[str, Any]]:
    """Runs a candidate; yields a line for each of its collisions."""
    traces.mkdir(parents=True, exist_ok=True)
    name = f"{part.agent}-{part.scene.replace(' ', '-')}-{repetition}-{number}"
    path = traces / f"{name}.parquet"
    report = _perform(RunSpec(run_id=name, document=document, trace_path=str(path)))
    collisions = [
        v for v in report.verdicts if v.oracle == "collision" and v.outcome is Outcome.VIOLATED
    ]
    if not collisions:
        path.unlink(missing_ok=True)
    for verdict in collisions:
        yield {
            "part": part.name,
            "agent": part.agent,
            "scene": part.scene,
            "repetition": repetition,
            "number": number,
            "trace": path.name,
            "trace_sha256": report.trace_sha256,
            **_verdict_content(verdict),
            "milliseconds": _cost(read_trace(path), verdict),
        }


def _perform(spec: RunSpec) -> RunReport:
    return perform(spec, WorkerSetup(shipped_networks=shipped_networks()))


def _verdict_content(verdict: Verdict) -> dict[str, Any]:
    return {
        "ego": verdict.ego,
        "counterpart": verdict.counterpart,
        "message": verdict.message,
        "at_fault": verdict.at_fault,
        "avoidable": verdict.avoidable,
        "physically_avoidable": verdict.physically_avoidable,
        "step": verdict.step,
        "time": verdict.time,
        "evidence": dict(verdict.evidence),
    }


def _cost(trace: Trace, verdict: Verdict) -> float:
    """Returns the milliseconds of the assessment, the least of three."""
    network = catalogues().networks.get(trace.network)
    row = next(actor.row for actor in trace.actors if actor.id == verdict.counterpart)
    spent = []
    for _ in range(3):
        ego = next(ego for ego in RunView(trace, network).egos if ego.id == verdict.ego)
        begun = time.perf_counter()
        assess(ego, (verdict.step or 0) - ego.first, row)
        spent.append(1000.0 * (time.perf_counter() - begun))
    return round(min(spent), 2)


def _lines(path: Path) -> Iterator[dict[str, Any]]:
    with path.open() as file:
        for line in file:
            yield json.loads(line)


def judge(options: argparse.Namespace) -> None:
    """Judges the stored traces by the current oracles, and rewrites their lines."""
    lines = list(_lines(options.results))
    with options.results.open("w") as file:
        for line in lines:
            trace = read_trace(options.traces / line["trace"])
            network = catalogues().networks.get(trace.network)
            verdict = next(
                verdict
                for verdict in Collision().judge(RunView(trace, network))
                if (verdict.ego, verdict.counterpart) == (line["ego"], line["counterpart"])
            )
            new = {**line, **_verdict_content(verdict), "milliseconds": _cost(trace, verdict)}
            file.write(json.dumps(new) + "\n")


def draw(options: argparse.Namespace) -> None:
    """Draws collisions as strips of moments, named after their traces."""
    for line in _lines(options.results):
        name = Path(line["trace"]).stem
        if name not in options.names:
            continue
        trace = read_trace(options.traces / line["trace"])
        network = catalogues().networks.get(trace.network)
        verdicts = Collision().judge(RunView(trace, network))
        options.folder.mkdir(parents=True, exist_ok=True)
        draw_strip(trace, network, verdicts, options.folder / f"{name}.png", count=5)


COLUMNS = (
    "collisions",
    "avoidable",
    "not",
    "not measurable",
    "not at fault, but avoidable",
    "physically avoidable",
)


def counts(lines: Sequence[Mapping[str, Any]]) -> tuple[int, ...]:
    """Returns the numbers of collisions, in the order of :data:`COLUMNS`."""
    answers = Counter(line["avoidable"] for line in lines)
    return (
        len(lines),
        *(answers[answer] for answer in ("yes", "no", "not_measurable")),
        sum(line["avoidable"] == "yes" and line["at_fault"] is False for line in lines),
        sum(line["physically_avoidable"] == "yes" for line in lines),
    )


def show(options: argparse.Namespace) -> None:
    """Prints the counts as Markdown: of all collisions, and of those at fault."""
    lines = list(_lines(options.results))
    for title, some in (
        ("all", lines),
        ("at fault", [line for line in lines if line["at_fault"]]),
    ):
        print(f"\n| {title} | {' | '.join(COLUMNS)} |")
        print("|---" * (len(COLUMNS) + 1) + "|")
        for name in (*dict.fromkeys(line["part"] for line in lines), "together"):
            here = [line for line in some if name in (line["part"], "together")]
            print(f"| {name} | " + " | ".join(str(n) for n in counts(here)) + " |")
    costs = np.array([line["milliseconds"] for line in lines])
    print(f"\nassessing one: median {np.median(costs):.1f} ms, at most {costs.max():.0f} ms")


def main() -> None:
    """Collects or shows."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(required=True)
    collecting = commands.add_parser("collect")
    collecting.add_argument("--out", type=Path, required=True)
    collecting.add_argument("--traces", type=Path, required=True, help="folder for the traces")
    collecting.add_argument("--agents", nargs="*", default=[], help="only these")
    collecting.set_defaults(do=collect)
    showing = commands.add_parser("show")
    showing.add_argument("results", type=Path)
    showing.set_defaults(do=show)
    judging = commands.add_parser("judge")
    judging.add_argument("results", type=Path)
    judging.add_argument("--traces", type=Path, required=True)
    judging.set_defaults(do=judge)
    drawing = commands.add_parser("draw")
    drawing.add_argument("results", type=Path)
    drawing.add_argument("--traces", type=Path, required=True)
    drawing.add_argument("--folder", type=Path, required=True, help="for the pictures")
    drawing.add_argument("--names", nargs="+", required=True, help="of traces, without .parquet")
    drawing.set_defaults(do=draw)
    options = parser.parse_args()
    options.do(options)


if __name__ == "__main__":
    main()
