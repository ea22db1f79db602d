"""Mutants that leave every ego's run as it was, and those of them that testers draw again.

On each scene with frequent failures, candidates are drawn and run, and some mutants of
each are run, too. A mutant that testers would draw again must leave the egos' runs as they were,
step by step: that is checked for all of them, and for as many mutants that redraw nothing but genes
without an effect (``worker.without_effect``). How many of the others leave them as they were tells
how much the criterion misses.

    python -m benchmarks.redrawn_mutants --out benchmarks/results/redrawn-mutants.jsonl
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.search_scenes import FREQUENT, Scene, catalogues, prepare_scene, scenes_of
from drivora_service.campaigns.evaluation.local_evaluator import LocalEvaluator
from drivora_service.execution.local import LocalExecutor
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.runs.candidate import CandidateSource
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.search.components import Mutation
from drivora_service.search.genes import GeneSpace
from drivora_service.search.mutation import GaussianMutation, RedrawSlice, redraw_genes
from drivora_service.search.redrawing import Redrawing
from drivora_service.search.space.source import space_of
from drivora_service.search.testers.behavexplor.mutation import WaypointNoise
from drivora_service.worker.setup import WorkerSetup

FOG = 90.0
"""Fog density of the foggy variant of a scene, per cent."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OnlyWithoutEffect:
    """Redraws some genes of those that were without an effect."""

    which: BoolArray

    def mutate(
        self,
        values: FloatArray,
        space: GeneSpace,
        random: np.random.Generator,
        *,
        strength: float = 1.0,  # noqa: ARG002 # has one strength
    ) -> FloatArray:
        """Returns a changed copy."""
        genes = np.flatnonzero(self.which & space.varies)
        some = np.zeros(len(space), dtype=np.bool_)
        some[random.permutation(genes)[: random.integers(1, len(genes) + 1)]] = True
        return redraw_genes(values, space, random, some)


MUTATIONS: dict[str, Mutation | None] = {
    "redraw-slice": RedrawSlice(),
    "gaussian": GaussianMutation(),
    "behavexplor": WaypointNoise(),
    "without effect": None,
}


def in_fog(scene: Scene) -> Scene:
    """Returns the foggy variant of a scene."""
    return replace(
        scene,
        name=f"{scene.name}, fog",
        scenario={**scene.scenario, "weather": {"fog_density": FOG}},
        space={**scene.space, "weather": False},
    )


class Laboratory:
    """Runs candidates of one scene."""

    def __init__(self, evaluator: LocalEvaluator, scene: Scene) -> None:
        (part,) = prepare_scene(scene).parts
        self._evaluator, self._source = evaluator, part.candidates.source
        self._agent = scene.agent
        self.space = part.candidates.genes
        self.decode_alike = space_of(self._source, catalogues().networks).decode_alike

    def run(self, values: Sequence[FloatArray]) -> list[tuple[FloatArray, RunReport] | None]:
        """Returns the repaired genes and the reports; ``None`` where a run was not judged."""
        specs = [
            RunSpec(
                run_id=f"redrawn-{number}",
                document="",
                agent=self._agent,
                candidate=CandidateSource(space=self._source, values=tuple(one.tolist())),
            )
            for number, one in enumerate(values)
        ]
        self._evaluator.submit(list(enumerate(specs)))
        found: list[tuple[FloatArray, RunReport] | None] = [None] * len(specs)
        while answers := self._evaluator.wait():
            for answer in answers:
                is_judged = answer.report.status is RunStatus.FINISHED
                if is_judged and answer.candidate is not None:
                    genes = np.array(answer.candidate.values)
                    found[answer.number] = (genes, answer.report)
        return found


def explore(
    laboratory: Laboratory, alike: Redrawing, mutation: str, options: argparse.Namespace
) -> Counter[str]:
    """Counts mutants: all, unchanged, drawn again, and drawn again although they changed a run."""
    random = np.random.default_rng(options.seed)
    space = laboratory.space
    drawn = [space.sample(random) for _ in range(options.parents)]
    counts: Counter[str] = Counter()
    for parent in laboratory.run(drawn):
        if parent is None:
            continue
        values, report = parent
        idle = np.zeros(len(space), dtype=np.bool_)
        idle[list(report.without_effect)] = True
        chosen = MUTATIONS[mutation] or OnlyWithoutEffect(which=idle)
        if MUTATIONS[mutation] is None and not (idle & space.varies).any():
            continue
        mutants = [chosen.mutate(values, space, random) for _ in range(options.mutants)]
        for mutant, ran in zip(mutants, laboratory.run(mutants), strict=True):
            if ran is None:
                continue
            is_same = ran[1].egos_sha256 == report.egos_sha256
            is_redrawn = not alike.may_change(mutant, values, idle)
            counts["mutants"] += 1
            counts["unchanged"] += is_same
            counts["redrawn"] += is_redrawn
            counts["redrawn, but changed"] += is_redrawn and not is_same
    return counts


def main() -> None:
    """Explores the scenes and prints a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--agent", nargs="+", default=["idm"])
    parser.add_argument("--parents", type=int, default=20)
    parser.add_argument("--mutants", type=int, default=10, help="mutants of each parent")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    options.out.parent.mkdir(parents=True, exist_ok=True)
    with (
        tempfile.TemporaryDirectory() as folder,
        LocalExecutor(
            slots=options.workers,
            setup=WorkerSetup(shipped_networks=shipped_networks()),
            folder=Path(folder),
        ) as executor,
        options.out.open("w") as out,
    ):
        for agent in options.agent:
            clear = scenes_of(FREQUENT, agent)
            for scene in (*clear, *map(in_fog, clear)):
                laboratory = Laboratory(LocalEvaluator(executor), scene)
                redrawing = Redrawing(decode_alike=laboratory.decode_alike, attempts=1)
                for mutation in MUTATIONS:
                    counts = explore(laboratory, redrawing, mutation, options)
                    line = {"scene": scene.name, "agent": agent, "mutation": mutation, **counts}
                    out.write(json.dumps(line) + "\n")
                    out.flush()
                    print(
                        f"| {scene.name} | {agent} | {mutation} | {counts['mutants']} | "
                        f"{counts['unchanged']} | {counts['redrawn']} | "
                        f"{counts['redrawn, but changed']} |",
                        flush=True,
                    )


if __name__ == "__main__":
    main()
