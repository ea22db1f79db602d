"""The templates of CI systems: valid, and their steps run from a wheel.

They find what it needs, as where users have made an image for their jobs: that is more than a
gigabyte, which the wheel's own test installs from the same metadata into an empty environment
(`test_wheel.py`). Neither compiles kernels anew.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml
from junitparser import JUnitXml

from tests.deploy.ci_steps import (
    Machine,
    install_as_gitlab,
    machine,
    run_action,
    run_gitlab_job,
)
from tests.deploy.machine_code import copy_machine_code

_SCHEMAS = {
    "github/gate/action.yml": ("vendor.github-actions",),
    "github/merge/action.yml": ("vendor.github-actions",),
    "github/search/action.yml": ("vendor.github-actions",),
    "github/workflow.yml": ("vendor.github-workflows",),
    "gitlab/drivora.gitlab-ci.yml": ("vendor.gitlab-ci", "--data-transform", "gitlab-ci"),
}
_INSTALL = "Install Drivora"


@pytest.fixture(scope="module")
def templates(repository: Path) -> Path:
    return repository / "deploy" / "ci"


@pytest.mark.parametrize("name", _SCHEMAS)
def test_templates_have_the_form_of_their_systems(templates: Path, name: str) -> None:
    command = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", *_SCHEMAS[name]]
    done = subprocess.run(
        [*command, str(templates / name)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_no_template_is_left_out(templates: Path) -> None:
    found = {str(path.relative_to(templates)) for path in templates.rglob("*.yml")}
    assert found == set(_SCHEMAS)


def test_all_actions_install_in_the_same_way(templates: Path) -> None:
    steps = [
        step["run"]
        for path in sorted(templates.glob("github/*/action.yml"))
        for step in yaml.safe_load(path.read_text())["runs"]["steps"]
        if step["name"] == _INSTALL
    ]
    assert len(steps) == 3
    assert len(set(steps)) == 1


@pytest.fixture(scope="module")
def packages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the packages of this environment, but for Drivora itself."""
    folder = tmp_path_factory.mktemp("image")
    left_out = re.compile(r"drivora|pip\b|.*\.pth$")
    for package in Path(sysconfig.get_path("purelib")).iterdir():
        if not left_out.match(package.name):
            (folder / package.name).symlink_to(package)
    return folder


@pytest.fixture
def user(tmp_path: Path, repository: Path) -> Path:
    """A user's repository: a suite, a baseline of nothing that fails, a gate and a campaign."""
    folder = tmp_path / "user"
    examples = repository / "openscenario_schemas" / "examples"
    (folder / "suites" / "smoke" / "scenarios").mkdir(parents=True)
    for name in ("roundabout-in-fog", "rural-in-carla-frame"):
        shutil.copy(examples / f"{name}.json", folder / "suites" / "smoke" / "scenarios")
    suite = {"name": "smoke", "scenarios": ["scenarios/*.json"]}
    (folder / "suites" / "smoke" / "suite.yaml").write_text(yaml.safe_dump(suite))
    (folder / "suites" / "gate.yaml").write_text("fail_on: [new, worse]\n")
    campaign = {
        "name": "all-way stop",
        "tester": {"name": "random"},
        "agent": {"name": "idm"},
        "scenario": json.loads((examples / "campaigns" / "orchard-lane.json").read_text()),
        "space": {
            "egos": 5,
            "optional": True,
            "max_ego_delay": 3.0,
            "vehicles": 0,
            "walkers": 0,
        },
        "budget": {"simulations": 20},
    }
    (folder / "suites" / "campaign.yaml").write_text(yaml.safe_dump(campaign))
    for arguments in (
        ("init", "--quiet"),
        ("add", "--all"),
        ("-c", "user.name=a", "-c", "user.email=a@b", "commit", "--quiet", "--message", "suite"),
    ):
        subprocess.run(["git", *arguments], cwd=folder, check=True)
    return folder


@pytest.fixture
def job(user: Path, packages: Path, tmp_path: Path) -> Iterator[Machine]:
    with machine(user, tmp_path / "runner") as one:
        one.variables["PYTHONPATH"] = str(packages)
        # Has pip not compile hundreds of modules, of which the steps import some: it reads a
        # negative option of the environment the other way round.
        one.variables["PIP_NO_COMPILE"] = "0"
        # They are for this version of Python.
        python = Path(sys.base_prefix) / "bin"
        one.variables["PATH"] = f"{python}{os.pathsep}{one.variables['PATH']}"
        yield one


def junit_counts(path: Path) -> tuple[int, int]:
    (suite,) = JUnitXml.fromfile(str(path))
    return suite.tests, suite.failures


@pytest.mark.slow(seconds=60)
def test_the_github_actions(
    job: Machine, wheel: Path, templates: Path, repository: Path, tmp_path: Path
) -> None:
    github = templates / "github"
    inputs = {
        "package": str(wheel),
        "suite": "suites/smoke",
        "agent": "idm",
        "gate-file": "suites/gate.yaml",
    }
    assert run_action(job, github / "gate", inputs, only=[_INSTALL]) == 0, job.printed
    (site,) = job.temp.glob("drivora/lib/python*/site-packages")
    copy_machine_code(repository / "drivora_service", site / "drivora_service")
    assert run_action(job, github / "gate", inputs, skipped=[_INSTALL]) == 0, job.printed
    assert "Gate passed: no failure" in job.summary
    reports = {"junit.xml", "report.html", "summary.md", "runs.csv", "results-.json"}
    assert {path.name for path in job.artifacts.iterdir()} == reports
    assert junit_counts(job.artifacts / "junit.xml") == (3, 0)

    # The service of the first use is still there, and is used.
    installed = {"server": job.variables["DRIVORA_SERVER"]}
    faster = {"agent-parameters": "speed_factor=1.3\n", "repetitions": "2"}
    code = run_action(job, github / "gate", {**inputs, **installed, **faster}, skipped=[_INSTALL])
    assert code == 1, job.printed
    assert junit_counts(job.artifacts / "junit.xml")[1] > 1
    assert "speeding" in job.summary

    # Each shard is a job of its own; their results come together in a folder.
    shards = tmp_path / "user" / "drivora-shards"
    for number in (1, 2):
        part = {"shard": f"{number}/2", "reports": f"shard-{number}"}
        code = run_action(job, github / "gate", {**inputs, **installed, **part}, skipped=[_INSTALL])
        assert code == 0, job.printed
        shutil.copytree(job.checkout / f"shard-{number}", shards / f"shard-{number}")
    merged = {key: value for key, value in inputs.items() if key != "agent"}
    code = run_action(job, github / "merge", {**merged, "reports": "merged"}, skipped=[_INSTALL])
    assert code == 0, job.printed
    assert junit_counts(job.checkout / "merged" / "junit.xml") == (3, 0)

    search = {"package": str(wheel), "campaigns": "suites/campaign.yaml\n", "suite": "suites/found"}
    assert run_action(job, github / "search", search, skipped=[_INSTALL]) == 0, job.printed
    assert int(job.outputs["found"]) >= 1
    check_patch(job, tmp_path, int(job.outputs["found"]))


@pytest.mark.slow(seconds=60)
def test_the_gitlab_jobs(
    job: Machine, wheel: Path, templates: Path, repository: Path, tmp_path: Path
) -> None:
    template = templates / "gitlab" / "drivora.gitlab-ci.yml"
    port = 8790
    common = {"DRIVORA_PACKAGE": str(wheel), "DRIVORA_SUITE": "suites/smoke"}
    gate = {**common, "DRIVORA_AGENT": "idm", "DRIVORA_PORT": str(port)}
    assert install_as_gitlab(job, template, ".drivora-gate", gate) == 0, job.printed
    (installed,) = job.checkout.glob(".drivora-environment/lib/python*/site-packages")
    copy_machine_code(repository / "drivora_service", installed / "drivora_service")
    assert run_gitlab_job(job, template, ".drivora-gate", gate) == 0, job.printed
    reports = job.checkout / "drivora-reports"
    assert junit_counts(reports / "junit.xml") == (3, 0)
    used = {**gate, "DRIVORA_SERVER": f"http://127.0.0.1:{port}"}
    faster = {**used, "DRIVORA_AGENT_PARAMETERS": "speed_factor=1.3"}
    assert run_gitlab_job(job, template, ".drivora-gate", faster) == 1
    assert junit_counts(reports / "junit.xml")[1] > 1
    (reports / "results-.json").unlink()
    for number in ("1", "2"):
        part = {**used, "CI_NODE_INDEX": number, "CI_NODE_TOTAL": "2"}
        assert run_gitlab_job(job, template, ".drivora-gate", part) == 0
    assert run_gitlab_job(job, template, ".drivora-merge", common) == 0, job.printed
    assert junit_counts(reports / "junit.xml") == (3, 0)
    search = {"DRIVORA_CAMPAIGNS": "suites/campaign.yaml", "DRIVORA_SUITE": "suites/found"}
    assert run_gitlab_job(job, template, ".drivora-search", search) == 0, job.printed
    check_patch(job, tmp_path, 1)


def check_patch(job: Machine, tmp_path: Path, least: int) -> None:
    """Applies the patch in a fresh clone, in which the suite then has the scenarios."""
    clone = tmp_path / "clone"
    subprocess.run(["git", "clone", "--quiet", str(job.checkout), str(clone)], check=True)
    patch = job.checkout / "drivora-found.patch"
    subprocess.run(["git", "apply", "--index", str(patch)], cwd=clone, check=True)
    assert len(list((clone / "suites" / "found" / "scenarios").iterdir())) >= least
    assert (clone / "suites" / "found" / "suite.yaml").is_file()
