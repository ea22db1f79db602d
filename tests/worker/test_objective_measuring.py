"""Runs of a worker, measured by what a campaign chose."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.feedback.objective_choice import ObjectiveChoice, ObjectiveKind
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.oracles.laws.law_judging import LawOracle
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.validation import validate_data
from drivora_service.worker import worker_catalogues
from drivora_service.worker.performing import perform
from drivora_service.worker.setup import WorkerSetup
from tests.installed_parts import install_parts

SETUP = WorkerSetup(shipped_networks=shipped_networks())
CODE = """\
from dataclasses import replace
from own_parts import METRIC, ORACLE, WalkerRuns
from drivora_service.oracles.plugin import OracleObjective

class Forgetful(WalkerRuns):
    @property
    def name(self):
        return "forgetful"

    def judge(self, run):
        from drivora_service.oracles.verdict import passed
        return tuple(passed(self.name, ego, "Well.") for ego in run.egos)

class Failing:
    def measure(self, ego):
        raise KeyError("walker")

named = OracleObjective(name="spare", description="It is not given.")
forgetful = replace(ORACLE, name="forgetful", create=Forgetful, objectives=(named,))
taken = replace(ORACLE, name="forgetful", create=lambda: Forgetful(), objectives=(
    OracleObjective(name="min_gap", description="It is Drivora's."),))
failing = replace(METRIC, name="failing", create=Failing)
"""


@pytest.fixture(autouse=True)
def _fresh() -> Iterator[None]:
    """Catalogues of this process that know what is installed now."""
    caches = (worker_catalogues._oracles, worker_catalogues._metrics)
    for cache in caches:
        cache.cache_clear()
    yield
    for cache in caches:
        cache.cache_clear()


def performed(*objectives: ObjectiveChoice, feedback: str = "general") -> RunReport:
    """Performs a short run, measured for a tester."""
    networks = NetworkCatalogue(shipped_networks())
    scenario = validate_data(SCENARIO, networks, None).scenario
    document = canonical_json(replace(scenario, max_sim_time=1.0))
    choice = FeedbackChoice(name=feedback, objectives=objectives)
    return perform(RunSpec(run_id="run", document=document, feedback=choice), SETUP)


def chosen(kind: ObjectiveKind, name: str, owner: str = "", **changes: Any) -> ObjectiveChoice:
    return ObjectiveChoice(name=name, kind=kind, owner=owner, member=name, **changes)


def test_what_was_chosen_stands_before_what_the_method_measures() -> None:
    report = performed(
        chosen(ObjectiveKind.METRIC, "mean_speed_mps"),
        replace(chosen(ObjectiveKind.METRIC, "mean_speed_mps", negated=True), name="negated_speed"),
        chosen(ObjectiveKind.FEEDBACK, "safety_margin", "avfuzzer"),
        chosen(ObjectiveKind.FEEDBACK, "lane_centre", "samota"),
        chosen(ObjectiveKind.LAW, "law_45_speed_limit", "law_45_speed_limit"),
    )
    assert report.measurement is not None, report.failure
    objectives = report.measurement.objectives
    speed = report.metrics["mean_speed_mps"]
    assert speed is not None
    assert list(objectives)[:2] == ["mean_speed_mps", "negated_speed"]
    assert (objectives["mean_speed_mps"], objectives["negated_speed"]) == (speed, -speed)
    assert objectives["min_gap"] == report.scores["min_gap"]
    (law,) = [one for one in report.verdicts if one.oracle == "law_45_speed_limit"]
    assert objectives["law_45_speed_limit"] == pytest.approx(law.evidence["robustness"], abs=1e-3)


def test_every_shipped_law_is_measured_as_its_verdict_says() -> None:
    laws = worker_catalogues.oracles_of(SETUP).laws()
    assert all(isinstance(law, LawOracle) for law in laws)
    report = performed(*(chosen(ObjectiveKind.LAW, law.name, law.name) for law in laws))
    assert report.measurement is not None, report.failure
    for verdict in report.verdicts:
        if "robustness" in verdict.evidence:
            measured = report.measurement.objectives[verdict.oracle]
            assert measured == pytest.approx(verdict.evidence["robustness"], abs=1e-3)


def test_parts_of_a_package_are_measured_in_every_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_parts(tmp_path / "site", monkeypatch)
    report = performed(
        chosen(ObjectiveKind.ORACLE, "walker_spare", "walker_runs"),
        chosen(ObjectiveKind.METRIC, "walker_speed_mps"),
    )
    assert report.status is RunStatus.FINISHED, report.failure
    assert report.measurement is not None
    # There is no walker: measured, and not measurable.
    assert report.scores["walker_spare"] is None
    assert report.metrics["walker_speed_mps"] is None
    assert report.measurement.objectives["walker_spare"] is None
    assert report.versions["own-parts"] == "0.1"


@pytest.mark.parametrize(
    ("parts", "cause", "message"),
    [
        (
            "[drivora_service.oracles]\nforgetful = more_parts:forgetful\n",
            "oracle_invalid_verdict",
            "passed without the evidence 'spare', which is one of its objectives",
        ),
        (
            "[drivora_service.oracles]\nforgetful = more_parts:taken\n",
            "oracle_invalid_verdict",
            "passed without the evidence 'min_gap'",
        ),
        (
            "[drivora_service.metrics]\nfailing = more_parts:failing\n",
            "metric_raised",
            "metric 'failing' of the package 'own-parts' raised KeyError",
        ),
        (
            "[drivora_service.metrics]\ngone_s = parts_that_are_gone:METRIC\n",
            "metric_plugin",
            "No module named 'parts_that_are_gone'",
        ),
    ],
)
def test_a_part_that_fails_ends_its_run_with_the_reason(
    parts: str, cause: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_parts(tmp_path / "site", monkeypatch, parts=parts, code=CODE)
    report = performed()
    assert report.status is RunStatus.PLUGIN_FAILED
    assert report.failure is not None
    assert report.failure.cause == cause
    assert message in report.failure.message


def test_an_objective_that_is_not_installed_here_names_what_to_install() -> None:
    report = performed(chosen(ObjectiveKind.METRIC, "walker_speed_mps"))
    assert report.status is RunStatus.PLUGIN_FAILED
    assert report.failure is not None
    assert "the metric 'walker_speed_mps' is not installed" in report.failure.message
