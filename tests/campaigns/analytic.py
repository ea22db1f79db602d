"""A world that can be computed: candidates are their values, a run is a formula."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from drivora_service.campaigns.evaluator import Answer
from drivora_service.campaigns.records.journal import Journal
from drivora_service.campaigns.search.engine import Engine, Search, Told
from drivora_service.campaigns.search.seed_turns import SearchPart
from drivora_service.feedback.measurement import FeedbackChoice, Measurement
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.oracles.verdicts.failure_definition import Counted, FailureDefinition
from drivora_service.runs.candidate import Candidate, CandidateSource, Reference, SpaceSource
from drivora_service.runs.report_encoding import report_from_json, report_to_json
from drivora_service.runs.run_report import RunFailure, RunReport, RunSpec, RunStatus
from drivora_service.search.genes import GeneSpace
from drivora_service.search.tester import Evaluation, Proposal, Tester
from drivora_service.store.campaigns.campaign_records import CampaignRequest, EvaluationRecord
from drivora_service.testing.gene_spaces import small_space
from drivora_service.worker.candidate_preparing import prepare
from drivora_service.worker.setup import WorkerSetup

NO_REQUEST = CampaignRequest.NONE


class Values:
    """Candidates whose document is their values.

    Repairing brings the first continuous gene to a grid; below a share of its range it is invalid.
    """

    def __init__(self, *, invalid_below: float = 0.0) -> None:
        self._space, self._invalid_below = small_space(), invalid_below
        self._grid = int(np.flatnonzero(~self._space.is_whole)[0])

    @property
    def genes(self) -> GeneSpace:
        return self._space

    @property
    def source(self) -> SpaceSource:
        return SpaceSource(seed="", options=json.dumps(self._invalid_below))

    def prepare(self, values: FloatArray, _reference: Reference | None = None) -> Candidate:
        repaired = values.copy()
        repaired[self._grid] = np.round(repaired[self._grid], 2)
        invalid = self._space.to_unit(repaired)[self._grid] < self._invalid_below
        return Candidate(
            values=tuple(repaired.tolist()),
            document="" if invalid else json.dumps(repaired.tolist()),
            problem="/npc_vehicles/0: too near" if invalid else "",
            prepare_s=0.01,
        )


def decode(source: CandidateSource) -> Candidate:
    """Prepares a candidate of this world, or of a real space."""
    if source.space.seed:
        return prepare(source, WorkerSetup(shipped_networks=shipped_networks()))
    values = Values(invalid_below=json.loads(source.space.options))
    return values.prepare(np.array(source.values))


def perform(spec: RunSpec) -> RunReport:
    """Computes the report of a run; one in seven violates an oracle, one in six fails."""
    unit = small_space().to_unit(np.array(json.loads(spec.document)))
    first, second = float(unit[2]), float(np.mean(unit[5:15]))
    if unit[1] > 0.9:
        failure = RunFailure(cause="agent_raised", message="the agent raised")
        return RunReport(run_id=spec.run_id, status=RunStatus.AGENT_FAILED, failure=failure)
    verdicts = [
        Verdict(oracle="collision", ego="ego_0", outcome=Outcome.PASSED, message=""),
        Verdict(
            oracle="speeding", ego="ego_0", outcome=Outcome.VIOLATED, message="", time=0.5, step=10
        ),
    ]
    if first < 0.15:
        verdicts[0] = Verdict(
            oracle="collision",
            ego="ego_0",
            outcome=Outcome.VIOLATED,
            message="",
            at_fault=second < 0.5,
            time=3.0 + first,
            step=60,
            location=(10.0 * first, 2.0),
            counterpart="vehicle_0",
            evidence={"face": "front", "ego_speed": np.float64(4.0 + first), "pair": (1, 2)},
        )
    return RunReport(
        run_id=spec.run_id,
        status=RunStatus.FINISHED,
        verdicts=tuple(verdicts),
        scores={"min_gap": first, "time_to_collision": None},
        measurement=Measurement(
            objectives={"min_gap": first, "time_to_collision": second, "progress": None},
            features={"profile": ((first, 1.0 / 3.0), (second, 0.1 + 0.2))},
        ),
        without_effect=(int(17 * first), 20),
        trace_sha256=hashlib.sha256(spec.document.encode()).hexdigest(),
        steps=100,
        sim_time_s=5.0,
        wall_time_s=0.1,
    )


class Computed:
    """An evaluator with ``slots`` places whose runs end in a random order."""

    def __init__(
        self,
        *,
        slots: int = 1,
        seed: int = 0,
        work: Callable[[RunSpec], RunReport] = perform,
    ) -> None:
        self._slots, self._work = slots, work
        self._random = np.random.default_rng(seed)
        self._queue: list[tuple[int, RunSpec]] = []
        self.submitted: list[int] = []
        self.most_under_way = 0

    def submit(self, runs: Sequence[tuple[int, RunSpec]]) -> None:
        self._queue += runs
        self.submitted += [number for number, _ in runs]
        self.most_under_way = max(self.most_under_way, len(self._queue))

    def wait(self, timeout: float | None = None) -> tuple[Answer, ...]:
        if not self._queue:
            return ()
        place = int(self._random.integers(min(self._slots, len(self._queue))))
        number, spec = self._queue.pop(place)
        if spec.candidate is None:
            return (Answer(number=number, report=_as_stored(self._work(spec))),)
        candidate = decode(spec.candidate)
        if candidate.problem:
            failure = RunFailure(cause="invalid_document", message=candidate.problem)
            report = RunReport(run_id=spec.run_id, status=RunStatus.INVALID, failure=failure)
        else:
            report = self._work(replace(spec, document=candidate.document, candidate=None))
        return (Answer(number=number, report=_as_stored(report), candidate=candidate),)

    def close(self) -> None:
        self._queue.clear()


def _as_stored(report: RunReport) -> RunReport:
    return report_from_json(report_to_json(report))


@dataclass(slots=True)
class Climber:
    """A small tester that depends on all evaluations: it mutates the best so far."""

    space: GeneSpace
    random: np.random.Generator
    told: list[Evaluation] = field(default_factory=list)
    best: Evaluation | None = None
    best_score: float = np.inf
    ends_after: int = 1_000_000

    def ask(self, room: int) -> tuple[Proposal, ...]:
        if len(self.told) >= self.ends_after:
            return ()
        return tuple(self._propose() for _ in range(room))

    def _propose(self) -> Proposal:
        if self.best is None or self.random.random() < 0.3:
            return Proposal(values=self.space.sample(self.random), origin="initial")
        unit = self.space.to_unit(self.best.proposal.values)
        moved = self.space.from_unit(unit + 0.05 * self.random.standard_normal(len(unit)))
        return Proposal(
            values=moved,
            origin="mutation",
            generation=len(self.told) // 10,
            parents=(self.best.number,),
        )

    def tell(self, evaluation: Evaluation) -> None:
        self.told.append(evaluation)
        if evaluation.measurement is None:
            return
        objectives = evaluation.measurement.objectives
        features = evaluation.measurement.features["profile"]
        score = (objectives["min_gap"] or 0.0) + features[1][0] - 0.1 * len(evaluation.violations)
        if score < self.best_score:
            self.best, self.best_score = evaluation, score


def climber(seed: int = 5) -> Climber:
    return Climber(space=small_space(), random=np.random.default_rng(seed))


def part_of(tester: Tester, candidates: Values) -> SearchPart:
    return SearchPart(tester=tester, candidates=candidates, kind_of=lambda verdict: verdict.oracle)


def search_of(tester: Tester, **changes: object) -> Search:
    fields: dict[str, object] = {
        "run_prefix": "test",
        "parts": (part_of(tester, Values(invalid_below=0.1)),),
        "feedback": FeedbackChoice(name="general"),
        "definition": FailureDefinition(counts=Counted.POSSIBLY_AT_FAULT, oracles=("collision",)),
        "budget": 60,
        "lookahead": 8,
    }
    return Search(**(fields | changes))  # type: ignore[arg-type] # the test names the fields


def run(
    journal: Journal,
    *,
    tester: Tester | None = None,
    evaluator: Computed | None = None,
    requested: Callable[[], CampaignRequest] = lambda: NO_REQUEST,
    on_told: Callable[[Told], None] = lambda _told: None,
    candidates: Values | None = None,
    **changes: object,
) -> CampaignRequest:
    """Runs a campaign of the climber in the computed world."""
    if candidates is not None:
        changes["parts"] = (part_of(tester or climber(), candidates),)
    search = search_of(tester or climber(), **changes)
    engine = Engine(search, evaluator or Computed(), journal, requested=requested, on_told=on_told)
    return engine.run()


def sequence(records: Sequence[EvaluationRecord]) -> list[tuple[object, ...]]:
    """Returns the parts of evaluations that must not depend on the circumstances."""
    return [
        (
            record.number,
            record.proposal.values.tobytes(),
            record.proposal.origin,
            record.proposal.generation,
            record.proposal.parents,
            record.status,
            record.document_sha256,
            record.violations,
            record.failure_kinds,
            record.report.measurement,
        )
        for record in records
    ]
