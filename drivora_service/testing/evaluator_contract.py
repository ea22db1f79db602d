"""The contract of evaluators, as a suite of tests for authors of evaluators.

Derive a class whose name begins with ``Test`` and say how to make one::

    class TestMyEvaluator(EvaluatorContract):
        def create(self, context: EvaluatorContext) -> Evaluator:
            return MY_PLUGIN.create(context)
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from drivora_service.campaigns.evaluator import Answer, Evaluator, EvaluatorContext
from drivora_service.execution.executor import Limits
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.runs.candidate import Candidate, CandidateSource
from drivora_service.runs.report_encoding import report_from_json, report_to_json
from drivora_service.runs.run_report import RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.check_warm_up import warm_up_checks
from drivora_service.scenario.model import Scenario
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.source import source_of
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.worker.candidate_preparing import prepare
from drivora_service.worker.setup import WorkerSetup

_LONG_S = 300.0
"""Timeout of the tests in seconds, far above any duration."""


class EvaluatorContract:
    """Tests that every evaluator passes."""

    def create(self, context: EvaluatorContext) -> Evaluator:
        """Makes the evaluator under test."""
        raise NotImplementedError

    def document(self, number: int) -> str:
        """Returns the canonical JSON text of a short scenario, a different one for each number."""
        scenario = warm_up_checks(NetworkCatalogue(shipped_networks()))
        return canonical_json(replace(scenario, max_sim_time=1.0 + 0.5 * number))

    def broken_document(self) -> str:
        """Returns a document that cannot be run."""
        scenario = warm_up_checks(NetworkCatalogue(shipped_networks()))
        nowhere = replace(scenario.map_region, town="no-town")
        return canonical_json(replace(scenario, map_region=nowhere))

    def source(self) -> CandidateSource:
        """Returns genes of a short scenario."""
        return self._source(warm_up_checks(NetworkCatalogue(shipped_networks())))

    def invalid_source(self) -> CandidateSource:
        """Returns genes that encode no valid scenario."""
        scenario = warm_up_checks(NetworkCatalogue(shipped_networks()))
        (ego,) = scenario.ego_vehicles
        unknown = replace(ego, agent=replace(ego.agent, name="no-agent"))
        return self._source(replace(scenario, ego_vehicles=(unknown,)))

    def _source(self, scenario: Scenario) -> CandidateSource:
        networks = NetworkCatalogue(shipped_networks())
        seed = replace(scenario, max_sim_time=1.0)
        options = SpaceOptions(vehicles=1, walkers=0)
        space = ScenarioSpace(seed, networks.get(seed.map_region.town), options)
        # Not repaired: the worker moves the vehicle out of the ego's way.
        return CandidateSource(space=source_of(space), values=tuple(space.genes.lows.tolist()))

    def decoded(self, source: CandidateSource) -> Candidate:
        """Returns what genes decode to."""
        return prepare(source, WorkerSetup(shipped_networks=shipped_networks()))

    @pytest.fixture
    def evaluator(self, tmp_path: Path) -> Iterator[Evaluator]:
        """The evaluator, with two workers."""
        context = EvaluatorContext(
            workers=2,
            setup=WorkerSetup(shipped_networks=shipped_networks()),
            limits=Limits(),
            folder=tmp_path,
        )
        with contextlib.closing(self.create(context)) as made:
            yield made

    def spec(self, number: int, document: str = "") -> RunSpec:
        """Returns the requests to run."""
        return RunSpec(
            run_id=f"contract-{number}",
            document=document or self.document(number),
            feedback=FeedbackChoice(name="general"),
        )

    def collect(self, evaluator: Evaluator, count: int) -> list[Answer]:
        """Waits for ``count`` answers."""
        answers: list[Answer] = []
        while len(answers) < count:
            came = evaluator.wait(_LONG_S)
            assert came, "no answer came although runs are under way"
            answers += came
        return answers

    def test_every_number_comes_back_once_with_its_own_report(self, evaluator: Evaluator) -> None:
        for number in range(5):
            evaluator.submit([(number, self.spec(number))])
        answers = self.collect(evaluator, 5)
        assert sorted(answer.number for answer in answers) == list(range(5))
        for answer in answers:
            assert answer.report.run_id == f"contract-{answer.number}"
            assert answer.report.status is RunStatus.FINISHED
        assert evaluator.wait(0.1) == ()

    def test_reports_are_judged_and_measured(self, evaluator: Evaluator) -> None:
        evaluator.submit([(7, self.spec(1))])
        (answer,) = self.collect(evaluator, 1)
        assert answer.number == 7
        assert answer.report.verdicts
        assert answer.report.measurement is not None

    def test_the_same_scenario_gives_the_same_trace(self, evaluator: Evaluator) -> None:
        for number in (0, 1):
            evaluator.submit([(number, self.spec(number, self.document(2)))])
        first, second = self.collect(evaluator, 2)
        assert first.report.trace_sha256 == second.report.trace_sha256 != ""
        assert first.report.measurement == second.report.measurement

    def test_what_cannot_be_run_is_answered_too(self, evaluator: Evaluator) -> None:
        evaluator.submit([(0, self.spec(0, self.broken_document()))])
        (answer,) = self.collect(evaluator, 1)
        assert answer.report.status is RunStatus.INVALID
        assert answer.report.failure is not None

    def test_genes_are_decoded_where_they_run(self, evaluator: Evaluator) -> None:
        source, feedback = self.source(), FeedbackChoice(name="general")
        spec = RunSpec(run_id="genes", document="", feedback=feedback, candidate=source)
        evaluator.submit([(0, spec)])
        (answer,) = self.collect(evaluator, 1)
        expected = self.decoded(source)
        assert answer.candidate is not None
        assert replace(answer.candidate, prepare_s=0.0) == replace(expected, prepare_s=0.0)
        assert answer.candidate.prepare_s > 0.0
        evaluator.submit([(1, replace(spec, document=expected.document, candidate=None))])
        (same,) = self.collect(evaluator, 1)
        assert same.candidate is None
        assert same.report.trace_sha256 == answer.report.trace_sha256 != ""

    def test_genes_without_a_valid_scenario_are_answered_with_their_problem(
        self, evaluator: Evaluator
    ) -> None:
        source = self.invalid_source()
        evaluator.submit([(0, RunSpec(run_id="invalid", document="", candidate=source))])
        (answer,) = self.collect(evaluator, 1)
        problem = self.decoded(source).problem
        assert problem
        assert answer.candidate is not None
        assert (answer.candidate.problem, answer.candidate.document) == (problem, "")
        assert answer.report.status is RunStatus.INVALID
        assert answer.report.failure is not None
        assert answer.report.failure.message == problem

    def test_reports_are_as_read_from_a_store(self, evaluator: Evaluator) -> None:
        evaluator.submit([(0, self.spec(0)), (1, self.spec(1, self.broken_document()))])
        for answer in self.collect(evaluator, 2):
            assert report_from_json(report_to_json(answer.report)) == answer.report

    def test_waiting_for_nothing_does_not_wait(self, evaluator: Evaluator) -> None:
        assert evaluator.wait() == ()

    def test_more_can_be_submitted_while_others_run(self, evaluator: Evaluator) -> None:
        evaluator.submit([(0, self.spec(0))])
        evaluator.submit([(1, self.spec(1))])
        came = list(evaluator.wait(_LONG_S))
        evaluator.submit([(2, self.spec(2))])
        came += self.collect(evaluator, 3 - len(came))
        assert sorted(answer.number for answer in came) == [0, 1, 2]

    def test_it_can_be_closed_in_the_middle_and_again(self, evaluator: Evaluator) -> None:
        for number in range(4):
            evaluator.submit([(number, self.spec(number))])
        evaluator.close()
        evaluator.close()
