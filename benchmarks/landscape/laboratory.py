"""Runs of candidates of a scene, outside a campaign, with what their traces show."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.search_scenes import Scene, catalogues, prepare_scene
from drivora_service.campaigns.evaluator import Evaluator
from drivora_service.campaigns.search.evaluation_judging import violations_of
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import Col, Trace
from drivora_service.observations.trace_files.trace_file import read_trace
from drivora_service.oracles.collision import Collision
from drivora_service.oracles.verdict import Outcome
from drivora_service.oracles.verdicts.accountability import Accountability, accountability
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus

AT_ONCE = 200
"""Runs whose traces are on the disk at a time."""

_MOTION = (Col.X, Col.Y, Col.YAW, Col.VX, Col.VY)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ran:
    """A simulated candidate.

    Attributes:
        values: (d,) genes.
        report: What was judged and measured.
        collided: Whether an ego touched another actor, by whose fault ever.
        at_fault: Whether an ego violated an oracle of the campaign by its own fault.
        avoidable: Whether it did in a way that counts as avoidable, as in the figures of a study.
        motion: Hash of the motion of all egos.
        parent: Place of the parent among the parents; -1 if it was drawn.
    """

    values: FloatArray
    report: RunReport
    collided: bool
    at_fault: bool
    avoidable: bool
    motion: str
    parent: int = -1


class Laboratory:
    """Runs candidates of one scene."""

    def __init__(self, evaluator: Evaluator, scene: Scene, folder: Path) -> None:
        """Prepares the space.

        Args:
            evaluator: Runs the candidates; it has no other user meanwhile.
            scene: The scene.
            folder: Where traces are written for the moment.
        """
        search = prepare_scene(scene)
        (part,) = search.parts
        self._evaluator, self._candidates, self._folder = evaluator, part.candidates, folder
        self._definition = search.definition
        self.space = part.candidates.genes
        self.network = catalogues().networks.get(scene.scenario["map_region"]["town"])

    def run(
        self, values: Sequence[FloatArray], parents: Sequence[int] = ()
    ) -> list[tuple[Ran, Trace]]:
        """Runs the valid candidates; those that could not be judged are left out."""
        prepared = [self._candidates.prepare(one) for one in values]
        valid = [number for number, candidate in enumerate(prepared) if not candidate.problem]
        specs = [
            RunSpec(
                run_id=f"landscape-{number}",
                document=prepared[number].document,
                trace_path=str(self._path(number)),
            )
            for number in valid
        ]
        self._evaluator.submit(list(zip(valid, specs, strict=True)))
        reports: dict[int, RunReport] = {}
        while answers := self._evaluator.wait():
            reports.update({answer.number: answer.report for answer in answers})
        found = []
        for number in valid:
            report = reports[number]
            if report.status is not RunStatus.FINISHED:
                continue
            trace = read_trace(self._path(number))
            self._path(number).unlink()
            parent = parents[number] if parents else -1
            found.append(
                (self._make_ran(np.array(prepared[number].values), report, trace, parent), trace)
            )
        return found

    def _path(self, number: int) -> Path:
        return self._folder / f"{number}.parquet"

    def _make_ran(self, values: FloatArray, report: RunReport, trace: Trace, parent: int) -> Ran:
        own = [one for one in violations_of(report, self._definition) if one.at_fault]
        return Ran(
            values=values,
            report=report,
            collided=any(
                one.oracle == Collision().name and one.outcome is Outcome.VIOLATED
                for one in report.verdicts
            ),
            at_fault=bool(own),
            avoidable=any(accountability(one) is Accountability.AVOIDABLE for one in own),
            motion=_motion_of_egos(trace),
            parent=parent,
        )


def _motion_of_egos(trace: Trace) -> str:
    moved = trace.states[:, : trace.ego_count][:, :, list(_MOTION)]
    return hashlib.sha256(np.ascontiguousarray(moved).tobytes()).hexdigest()
