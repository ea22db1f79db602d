"""The landscape of the search: whether small changes of telling scenarios fail more often.

On every scene of a study, scenarios are drawn anew and run against an ADS. Then some are changed a
little (normal draws with a tenth of a gene's range), again and again: those that failed by the
ego's fault; of those without any collision, the ones that a measure puts nearest to a failure, and
others, drawn by lot. A search by mutation can beat drawing anew only where changes of the chosen
fail more often than that. How many changes leave the motion of the egos as it was is counted, too:
they tell nothing.

    python -m benchmarks.landscape --out benchmarks/results/landscape.jsonl
    python -m benchmarks.landscape show benchmarks/results/landscape.jsonl
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from benchmarks.landscape.laboratory import AT_ONCE, Laboratory, Ran
from benchmarks.landscape.nearness import MEASURES
from benchmarks.search_scenes import FREQUENT, Scene, scenes_of
from drivora_service.campaigns.evaluation.local_evaluator import LocalEvaluator
from drivora_service.execution.local import LocalExecutor
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.observations.run_view import RunView
from drivora_service.search.mutation import GaussianMutation
from drivora_service.worker.setup import WorkerSetup

AGENTS = ("idm", "pdm-closed", "plant-lite")


@dataclass(frozen=True, slots=True, kw_only=True)
class Group:
    """The runs of a group of scenarios.

    Attributes:
        runs: Their number.
        at_fault: Number that failed by the ego's fault.
        avoidable: Number of those that a careful and competent driver avoids.
        unchanged: Number in which all egos moved as in the run of the parent.
    """

    scene: str
    agent: str
    group: str
    runs: int
    at_fault: int
    avoidable: int
    unchanged: int


class Exploration:
    """The groups of one scene and ADS."""

    def __init__(self, laboratory: Laboratory, scene: Scene, options: argparse.Namespace) -> None:
        self._laboratory, self._scene, self._options = laboratory, scene, options
        self._random = np.random.default_rng(options.seed)

    def groups(self) -> Iterable[Group]:
        """Yields the groups, each as soon as it has been run."""
        drawn, nearness = self._draw()
        yield self._group("drawn anew", drawn, ())
        failed = [one for one in drawn if one.at_fault]
        places = [number for number, one in enumerate(drawn) if not one.collided]
        passing = [place for place in places if not drawn[place].at_fault]
        lot = self._random.permutation(passing)[: self._options.parents]
        chosen = {"failing": failed, "by lot": [drawn[place] for place in lot]}
        for name in MEASURES:
            ranked = sorted(passing, key=lambda place: nearness[name][place])
            chosen[f"nearest by {name}"] = [drawn[i] for i in ranked[: self._options.parents]]
        for name, parents in chosen.items():
            if parents:
                yield self._group(f"{name}, changed", self._change(parents), parents)

    def _draw(self) -> tuple[list[Ran], dict[str, list[float]]]:
        drawn: list[Ran] = []
        nearness: dict[str, list[float]] = {name: [] for name in MEASURES}
        left = self._options.draws
        while left > 0:
            some = self._laboratory.space.sample(self._random, min(left, AT_ONCE))
            left -= len(some)
            for one, trace in self._laboratory.run(list(some)):
                drawn.append(one)
                view = RunView(trace, self._laboratory.network)
                for name, measure in MEASURES.items():
                    nearness[name].append(measure(view))
        return drawn, nearness

    def _change(self, parents: Sequence[Ran]) -> list[Ran]:
        mutation, space = GaussianMutation(), self._laboratory.space
        changed: list[Ran] = []
        for first in range(0, self._options.changes, AT_ONCE):
            numbers = range(first, min(first + AT_ONCE, self._options.changes))
            places = [number % len(parents) for number in numbers]
            values = [mutation.mutate(parents[i].values, space, self._random) for i in places]
            changed += [one for one, _ in self._laboratory.run(values, places)]
        return changed

    def _group(self, name: str, ran: Sequence[Ran], parents: Sequence[Ran]) -> Group:
        return Group(
            scene=self._scene.name,
            agent=self._scene.agent,
            group=name,
            runs=len(ran),
            at_fault=sum(one.at_fault for one in ran),
            avoidable=sum(one.avoidable for one in ran),
            unchanged=sum(one.motion == parents[one.parent].motion for one in ran if parents),
        )


def show(groups: Sequence[Group]) -> None:
    """Prints the groups as a table in Markdown."""
    print("| scene | ADS | scenarios | at fault | avoidable | motion unchanged |")
    print("|---|---|---|---|---|---|")
    for one in groups:
        shares = [
            f"{count} of {one.runs} ({count / max(one.runs, 1):.1%})"
            for count in (one.at_fault, one.avoidable, one.unchanged)
        ]
        if one.group == "drawn anew":
            shares[-1] = ""
        print(f"| {one.scene} | `{one.agent}` | {one.group} | {' | '.join(shares)} |")


def _read(path: Path) -> list[Group]:
    return [Group(**json.loads(line)) for line in path.read_text().splitlines()]


def main(arguments: Sequence[str]) -> None:
    """Explores scenes that the file lacks, and prints a table of all."""
    if arguments[:1] == ["show"]:
        show(_read(Path(arguments[1])))
        return
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="JSON lines; others are kept")
    parser.add_argument("--study", type=Path, default=FREQUENT, help="study file with the scenes")
    parser.add_argument("--agents", nargs="+", default=AGENTS)
    parser.add_argument("--draws", type=int, default=1000, help="scenarios drawn anew")
    parser.add_argument("--parents", type=int, default=24, help="scenarios of a group to change")
    parser.add_argument("--changes", type=int, default=480, help="changed scenarios of a group")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(arguments)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    known = _read(options.out) if options.out.is_file() else []
    done = {(one.scene, one.agent) for one in known}
    with (
        tempfile.TemporaryDirectory() as folder,
        LocalExecutor(
            slots=options.workers,
            setup=WorkerSetup(shipped_networks=shipped_networks()),
            folder=Path(folder),
        ) as executor,
    ):
        for agent in options.agents:
            for scene in scenes_of(options.study, agent):
                if (scene.name, agent) in done:
                    continue
                traces = Path(folder) / "traces"
                traces.mkdir(exist_ok=True)
                laboratory = Laboratory(LocalEvaluator(executor), scene, traces)
                found = list(Exploration(laboratory, scene, options).groups())
                # All groups of a scene and an ADS at once: a file never has a part of them.
                with options.out.open("a") as out:
                    out.writelines(json.dumps(asdict(one)) + "\n" for one in found)
                print(f"{scene.name}, {agent}: done", file=sys.stderr, flush=True)
    show(_read(options.out))


if __name__ == "__main__":
    main(sys.argv[1:])
