"""The landscape of the search: whether small changes of critical scenarios fail more often.

On every scene with one ego of the study, scenarios are drawn anew and run. Then some are changed in
one gene of one actor, again and again: those that failed by the ego's fault; of those that did not,
the ones that each method's feedback puts nearest to a failure; and others, drawn by lot. A search
by mutation can beat drawing anew only where changes of the chosen fail more often than that.

    python -m benchmarks.search_landscape --out benchmarks/results/landscape.jsonl
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.method_study import ARMS, SCENES, Scene, campaign_document, catalogues
from drivora_service.campaigns.engine import Search
from drivora_service.campaigns.evaluator import Evaluator
from drivora_service.campaigns.judging import violations_of
from drivora_service.campaigns.local_evaluator import LocalEvaluator
from drivora_service.campaigns.preparing import prepare_search
from drivora_service.campaigns.reading import read_campaign
from drivora_service.execution.local import LocalExecutor
from drivora_service.feedback.avfuzzer import SAFETY_MARGIN
from drivora_service.feedback.behavexplor import DEGREE
from drivora_service.feedback.samota import VEHICLE
from drivora_service.geometry.arrays import FloatArray
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.runs.report import RunSpec
from drivora_service.search.mutation import RedrawSlice
from drivora_service.worker.setup import WorkerSetup

OBJECTIVES = {"avfuzzer": SAFETY_MARGIN, "behavexplor": DEGREE, "samota": VEHICLE}
"""The objective of each method; of SAMOTA's six, that of collisions."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ran:
    """A simulated scenario.

    Attributes:
        values: (d,) genes.
        failed: Whether an ego violated an oracle by its own fault.
        objective: What was measured, ``None`` where nothing could be.
    """

    values: FloatArray
    failed: bool
    objective: float | None


class Laboratory:
    """Runs scenarios of one scene."""

    def __init__(self, evaluator: Evaluator, scene: Scene) -> None:
        document = json.dumps(campaign_document(scene, ARMS[0], 1, 1))
        self._search: Search = prepare_search(
            read_campaign(document, catalogues()), catalogues(), run_prefix="landscape"
        )
        (part,) = self._search.parts
        self._evaluator, self._candidates = evaluator, part.candidates
        self.space = part.candidates.genes

    def run(self, values: Sequence[FloatArray], method: str) -> list[Ran]:
        """Runs the valid candidates, measured by a method's feedback."""
        feedback = catalogues().testers.plugin(method).feedback
        prepared = [self._candidates.prepare(one) for one in values]
        valid = [candidate for candidate in prepared if not candidate.problem]
        specs = [
            RunSpec(run_id=f"landscape-{number}", document=candidate.document, feedback=feedback)
            for number, candidate in enumerate(valid)
        ]
        self._evaluator.submit(list(enumerate(specs)))
        reports = {}
        while answers := self._evaluator.wait():
            reports.update({answer.number: answer.report for answer in answers})
        found = []
        for number, candidate in enumerate(valid):
            report = reports[number]
            violations = violations_of(report, self._search.oracles)
            found.append(
                Ran(
                    values=np.array(candidate.values),
                    failed=any(verdict.at_fault for verdict in violations),
                    objective=None
                    if report.measurement is None
                    else report.measurement.objectives[OBJECTIVES[method]],
                )
            )
        return found

    def change(self, parents: Sequence[Ran], count: int, random: np.random.Generator) -> list[Ran]:
        """Changes parents in turn until there are ``count`` changed ones, and runs those."""
        if not parents:
            return []
        mutation = RedrawSlice()
        values = [
            mutation.mutate(parents[i % len(parents)].values, self.space, random)
            for i in range(count)
        ]
        return self.run(values, "avfuzzer")


def explore(laboratory: Laboratory, options: argparse.Namespace) -> dict[str, tuple[int, int]]:
    """Returns the numbers of runs and failures of every group."""
    random = np.random.default_rng(options.seed)
    drawn = [laboratory.space.sample(random) for _ in range(options.draws)]
    groups: dict[str, tuple[int, int]] = {}
    for method in OBJECTIVES:
        ran = laboratory.run(drawn, method)
        passing = [one for one in ran if not one.failed]
        if not groups:
            groups["drawn anew"] = _counts(ran)
            failed = [one for one in ran if one.failed]
            groups["failing, changed"] = _counts(laboratory.change(failed, options.changes, random))
            others = [passing[i] for i in random.permutation(len(passing))[: options.parents]]
            groups["passing, changed"] = _counts(laboratory.change(others, options.changes, random))
        measured = [one for one in passing if one.objective is not None]
        nearest = sorted(measured, key=lambda one: one.objective or 0.0)[: options.parents]
        groups[f"nearest by {method}, changed"] = _counts(
            laboratory.change(nearest, options.changes, random)
        )
    return groups


def _counts(ran: Sequence[Ran]) -> tuple[int, int]:
    return len(ran), sum(one.failed for one in ran)


def main() -> None:
    """Explores the scenes and prints a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--draws", type=int, default=400, help="scenarios drawn anew")
    parser.add_argument("--parents", type=int, default=20, help="scenarios of a group to change")
    parser.add_argument("--changes", type=int, default=300, help="changed scenarios of a group")
    parser.add_argument("--workers", type=int, default=2)
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
        for scene in (scene for scene in SCENES if scene.egos == "one ego"):
            groups = explore(Laboratory(LocalEvaluator(executor), scene), options)
            for group, (runs, failed) in groups.items():
                line = {"scene": scene.name, "group": group, "runs": runs, "failed": failed}
                out.write(json.dumps(line) + "\n")
                share = failed / runs if runs else 0.0
                print(
                    f"{scene.name:20} {group:32} {failed:4} of {runs:4} ({share:.1%})",
                    flush=True,
                )
            out.flush()


if __name__ == "__main__":
    main()
