from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drivora_service.campaigns.evaluation.evaluator_catalogue import evaluator_plugins
from drivora_service.campaigns.evaluation.local_evaluator import LOCAL, LocalEvaluator
from drivora_service.campaigns.evaluator import Evaluator, EvaluatorContext
from drivora_service.errors import UnknownName
from drivora_service.execution.local import LocalExecutor
from drivora_service.runs.candidate import Candidate, CandidateSource
from drivora_service.runs.run_report import RunFailure, RunReport, RunSpec, RunStatus
from drivora_service.testing.evaluator_contract import EvaluatorContract
from drivora_service.testing.gene_spaces import small_space
from tests.campaigns.analytic import Computed, Values, decode, perform


class TestComputed(EvaluatorContract):
    def create(self, context: EvaluatorContext) -> Evaluator:
        return Computed(slots=context.workers, work=self.work)

    def source(self) -> CandidateSource:
        space = Values(invalid_below=0.5).source
        genes = small_space()
        values = genes.from_unit(np.full(len(genes), 0.6))
        return CandidateSource(space=space, values=tuple(values.tolist()))

    def invalid_source(self) -> CandidateSource:
        return replace(self.source(), values=tuple(small_space().lows.tolist()))

    def decoded(self, source: CandidateSource) -> Candidate:
        return decode(source)

    def document(self, number: int) -> str:
        values = small_space().lows.copy()
        values[2] = 0.1 * number
        return json.dumps(values.tolist())

    def broken_document(self) -> str:
        return "{}"

    @staticmethod
    def work(spec: RunSpec) -> RunReport:
        if spec.document == "{}":
            failure = RunFailure(cause="invalid_document", message="no values")
            return RunReport(run_id=spec.run_id, status=RunStatus.INVALID, failure=failure)
        return perform(spec)


@pytest.mark.slow
class TestLocal(EvaluatorContract):
    def create(self, context: EvaluatorContext) -> Evaluator:
        return LOCAL.create(context)


def on_tasks(folder: Path) -> LocalEvaluator:
    """An evaluator whose workers do what documents say."""
    executor = LocalExecutor(
        slots=2,
        setup=None,
        folder=folder,
        perform="tests.execution.worker_tasks:perform",
        warm_up="",
    )
    return LocalEvaluator(executor)


def test_a_crash_is_confirmed_before_it_is_answered(tmp_path: Path) -> None:
    evaluator = on_tasks(tmp_path)
    try:
        evaluator.submit([(3, RunSpec(run_id="crash", document="segfault"))])
        evaluator.submit([(4, RunSpec(run_id="fine", document="sleep 0"))])
        answers: dict[int, RunStatus] = {}
        while len(answers) < 2:
            answers.update({a.number: a.report.status for a in evaluator.wait(60.0)})
        # Each attempt leaves its trace in the log of the worker that died of it.
        logs = "".join(path.read_text() for path in tmp_path.glob("*.log"))
    finally:
        evaluator.close()
    assert answers == {3: RunStatus.SIMULATOR_CRASHED, 4: RunStatus.FINISHED}
    assert logs.count("about to touch address zero") == 2


def test_waiting_ends_in_time_while_a_run_goes_on(tmp_path: Path) -> None:
    evaluator = on_tasks(tmp_path)
    try:
        evaluator.submit([(0, RunSpec(run_id="long", document="hangs"))])
        assert evaluator.wait(0.2) == ()
    finally:
        evaluator.close()


def test_evaluators_are_found_by_name() -> None:
    assert "local" in evaluator_plugins().names()
    with pytest.raises(UnknownName, match="known: local"):
        evaluator_plugins().plugin("cloud")
