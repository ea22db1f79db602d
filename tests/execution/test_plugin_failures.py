"""Code of packages and SUMO itself, failing in real workers: each run once, and with its status."""

from __future__ import annotations

import importlib
import shutil
import time
from dataclasses import replace
from pathlib import Path

import pytest

from drivora_service.execution.executor import Limits
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.spec_running import run_all
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_document
from drivora_service.worker.setup import WorkerSetup
from tests.execution.foreign_plugins import NAP_S

DEADLINE_S = 2.0
PLUGINS = """\
[drivora_service.agents]
slow-starter = foreign_plugins:slow_starter
saboteur = foreign_plugins:saboteur
[drivora_service.feedback]
moody = foreign_plugins:moody
broken = feedbacks_that_are_gone:plugin
"""


@pytest.fixture(scope="module")
def document() -> str:
    """A drive of five seconds."""
    networks = NetworkCatalogue(shipped_networks())
    (seed,) = generate_seeds(
        networks.get("tee-town"), count=1, min_length=50, max_length=80, seed=3, agent="idm"
    )
    drive = validate_document(seed, networks, ("idm",)).scenario
    return canonical_json(replace(drive, max_sim_time=5.0))


@pytest.fixture(autouse=True)
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The plug-ins as a package that Python finds on its path."""
    site = tmp_path / "site"
    info = site / "foreign_plugins-1.0.dist-info"
    info.mkdir(parents=True)
    shutil.copy(Path(__file__).with_name("foreign_plugins.py"), site)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: foreign-plugins\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(PLUGINS)
    monkeypatch.syspath_prepend(str(site))
    importlib.invalidate_caches()


def judged(folder: Path, *specs: RunSpec) -> tuple[list[RunReport], int]:
    """Runs on one worker; returns the reports in order, and the number of attempts."""
    setup = WorkerSetup(shipped_networks=shipped_networks(), agent_deadline_s=DEADLINE_S)
    limits = Limits(agent_deadline_s=DEADLINE_S)
    with LocalExecutor(slots=1, setup=setup, folder=folder / "workers", limits=limits) as executor:
        found = {report.run_id: report for report in run_all(executor, specs)}
        (slot,) = executor.slots()
    return [found[spec.run_id] for spec in specs], slot.runs


@pytest.mark.slow
def test_a_feedback_that_fails_fails_its_run_once_and_no_other(
    document: str, tmp_path: Path
) -> None:
    moods = ("raises", "leaves", "text", "other", "infinite", "unmade", "good")
    choices = [FeedbackChoice(name="moody", parameters={"mood": mood}) for mood in moods]
    choices.append(FeedbackChoice(name="broken"))
    specs = [
        RunSpec(run_id=str(number), document=document, feedback=choice)
        for number, choice in enumerate(choices)
    ]
    reports, attempts = judged(tmp_path, *specs)
    assert attempts == len(specs)
    fine = reports.pop(moods.index("good"))
    assert fine.status is RunStatus.FINISHED
    assert fine.measurement is not None
    assert {report.status for report in reports} == {RunStatus.PLUGIN_FAILED}
    failures = [report.failure for report in reports]
    # What code of the plug-in raised has the place in it.
    assert failures[0] is not None
    assert "foreign_plugins.py, line " in failures[0].message
    said = [(one.cause, one.message.partition(" (/")[0]) for one in failures if one]
    expected = [
        ("raised", "raised ZeroDivisionError when it measured a run: in a bad mood"),
        ("raised", "raised SystemExit when it measured a run: 3"),
        ("invalid_measurement", "answered a str; allowed: a Measurement"),
        ("invalid_measurement", "answered the objectives distance; it promised: gap"),
        ("invalid_measurement", "answered inf for 'gap'; allowed: a finite number, or None"),
        ("raised", "raised KeyError when it was made: 'nothing to make it of'"),
    ]
    assert said[:-1] == [
        (f"feedback_{cause}", f"feedback 'moody' of the package 'foreign-plugins' {text}")
        for cause, text in expected
    ]
    assert said[-1][0] == "feedback_plugin"
    assert "No module named 'feedbacks_that_are_gone'" in said[-1][1]
    assert failures[0] is not None
    assert "foreign_plugins.py" in failures[0].log
    # The recording is kept for inspection.
    assert reports[0].trace_sha256 == fine.trace_sha256
    assert not reports[0].verdicts


@pytest.mark.slow
def test_an_error_of_sumo_is_a_crash_of_the_simulator_and_not_repeated(
    document: str, tmp_path: Path
) -> None:
    spec = RunSpec(run_id="run", document=document, agent="saboteur")
    (report, after), attempts = judged(tmp_path, spec, RunSpec(run_id="after", document=document))
    assert attempts == 2
    assert report.status is RunStatus.SIMULATOR_CRASHED, report.failure
    assert report.failure is not None
    assert report.failure.cause == "simulator_error"
    assert "SUMO" in report.failure.message
    assert after.status is RunStatus.FINISHED


@pytest.mark.slow
def test_an_agent_may_need_nearly_its_deadline_to_set_up_and_again_for_its_first_step(
    document: str, tmp_path: Path
) -> None:
    assert DEADLINE_S < 2.0 * NAP_S
    begun = time.monotonic()
    (report,), _ = judged(tmp_path, RunSpec(run_id="run", document=document, agent="slow-starter"))
    assert time.monotonic() - begun > 2.0 * NAP_S
    assert report.status is RunStatus.FINISHED, report.failure
