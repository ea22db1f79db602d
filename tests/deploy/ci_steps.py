"""Runs the steps of CI templates as the CI systems do: each in a shell, one after the other."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

_EXPRESSION = re.compile(r"\$\{\{\s*(.*?)\s*\}\}")
_EMPTY = re.compile(r"inputs\.([a-z-]+) == ''")
_TIME_LIMIT_S = 600.0


@dataclass(slots=True)
class Machine:
    """What the steps of a job share: folders, and variables that steps set.

    Attributes:
        checkout: Folder of the repository, in which steps run.
        temp: Folder for temporary files.
        variables: Environment of the steps.
        printed: What they printed.
    """

    checkout: Path
    temp: Path
    variables: dict[str, str] = field(default_factory=dict)
    printed: str = ""

    @property
    def artifacts(self) -> Path:
        """Folder of what was uploaded."""
        return self.temp / "artifacts"

    @property
    def summary(self) -> str:
        """The summary of the job."""
        path = self.temp / "GITHUB_STEP_SUMMARY"
        return path.read_text() if path.is_file() else ""

    @property
    def outputs(self) -> dict[str, str]:
        """Outputs of the steps."""
        return dict(_assignments(self.temp / "GITHUB_OUTPUT"))

    def shell(self, program: list[str], script: str, variables: Mapping[str, str]) -> int:
        """Runs a script and returns its exit code."""
        log = self.temp / "step.log"
        with log.open("w") as target:
            process = subprocess.Popen(
                [*program, script],
                cwd=self.checkout,
                env={**self.variables, **variables},
                stdout=target,
                stderr=subprocess.STDOUT,
                stdin=subprocess.DEVNULL,
            )
            code = process.wait(_TIME_LIMIT_S)
        self.printed += log.read_text()
        return code


@contextmanager
def machine(checkout: Path, temp: Path) -> Iterator[Machine]:
    """Yields a machine with nothing but the system's programs; ends what it started."""
    temp.mkdir(parents=True, exist_ok=True)
    home = temp / "home"
    home.mkdir(exist_ok=True)
    kept = ("PATH", "LANG", "PIP_INDEX_URL", "PIP_CONFIG_FILE", "PIP_FIND_LINKS", "LD_LIBRARY_PATH")
    variables = {name: os.environ[name] for name in kept if name in os.environ}
    # Without the environment in which the tests run.
    paths = variables["PATH"].split(os.pathsep)
    variables["PATH"] = os.pathsep.join(path for path in paths if ".venv" not in path)
    mark = f"drivora-ci-{os.getpid()}-{temp.name}"
    job = Machine(checkout, temp, {**variables, "HOME": str(home), "DRIVORA_TEST_JOB": mark})
    try:
        yield job
    finally:
        _end_processes(mark)


def run_action(
    job: Machine,
    action: Path,
    inputs: Mapping[str, str],
    *,
    skipped: Collection[str] = (),
    only: Collection[str] = (),
) -> int:
    """Runs a composite action of GitHub; returns the exit code of its first step that fails.

    Args:
        job: The machine.
        action: Folder of ``action.yml``.
        inputs: Given inputs; the others have their defaults.
        skipped: Names of steps that are not run.
        only: Names of the steps that are run; empty: all others.
    """
    content = yaml.safe_load((action / "action.yml").read_text())
    given = {name: one.get("default", "") for name, one in content["inputs"].items()}
    for name, one in content["inputs"].items():
        assert name in inputs or "default" in one, f"input {name} is required"
    assert inputs.keys() <= given.keys()
    values = {**given, **inputs}
    failed = 0
    for step in content["runs"]["steps"]:
        if step["name"] in skipped or (only and step["name"] not in only):
            continue
        if not _is_wanted(step.get("if", ""), values, failed):
            continue
        if "uses" in step:
            _upload(job, step, values)
            continue
        variables = {name: _text(value, values, job) for name, value in step["env"].items()}
        code = _step(job, step["run"], variables)
        failed = failed or code
    return failed


def install_as_gitlab(job: Machine, template: Path, name: str, variables: Mapping[str, str]) -> int:
    """Runs the ``before_script`` of a job of a GitLab template; returns its exit code."""
    return _gitlab_lines(job, template, name, variables, lambda before, _: before)


def run_gitlab_job(job: Machine, template: Path, name: str, variables: Mapping[str, str]) -> int:
    """Runs a job of a GitLab template in a POSIX shell; returns its exit code.

    Of its ``before_script``, which has been run, it repeats what ends with the shell.

    Args:
        job: The machine.
        template: The file.
        name: The job.
        variables: Those of the user.
    """
    return _gitlab_lines(
        job, template, name, variables, lambda before, script: [before[-1], *script]
    )


def _gitlab_lines(
    job: Machine,
    template: Path,
    name: str,
    variables: Mapping[str, str],
    chosen: Callable[[list[str], list[str]], list[str]],
) -> int:
    content = yaml.safe_load(template.read_text())
    chain = [content[name]]
    while "extends" in chain[0]:
        chain.insert(0, content[chain[0]["extends"]])
    defined: dict[str, str] = {}
    scripts: dict[str, list[str]] = {}
    for one in chain:
        defined |= one.get("variables", {})
        scripts |= {key: one[key] for key in ("before_script", "script") if key in one}
    lines = chosen(scripts["before_script"], scripts["script"])
    unset = dict.fromkeys(("CI_NODE_INDEX", "CI_NODE_TOTAL"), "")
    return job.shell(["sh", "-ec"], "\n".join(lines), {**unset, **defined, **variables})


def _step(job: Machine, script: str, variables: Mapping[str, str]) -> int:
    files = {
        name: job.temp / name
        for name in ("GITHUB_ENV", "GITHUB_PATH", "GITHUB_OUTPUT", "GITHUB_STEP_SUMMARY")
    }
    for path in files.values():
        path.touch()
    runner = {name: str(path) for name, path in files.items()} | {"RUNNER_TEMP": str(job.temp)}
    program = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c"]
    code = job.shell(program, script, {**runner, **variables})
    job.variables |= dict(_assignments(files["GITHUB_ENV"]))
    added = files["GITHUB_PATH"].read_text().split()
    files["GITHUB_PATH"].write_text("")
    job.variables["PATH"] = os.pathsep.join([*reversed(added), job.variables["PATH"]])
    return code


def _assignments(path: Path) -> Iterator[tuple[str, str]]:
    for line in path.read_text().splitlines() if path.is_file() else ():
        name, _, value = line.partition("=")
        yield name, value


def _is_wanted(condition: str, inputs: Mapping[str, str], failed: int) -> bool:
    match = _EXPRESSION.fullmatch(condition)
    text = match[1] if match else condition
    if text == "always()":
        return True
    empty = _EMPTY.fullmatch(text)
    assert not text or empty, f"the tests do not know the condition {text}"
    return not failed and (empty is None or not inputs[empty[1]])


def _text(value: object, inputs: Mapping[str, str], job: Machine) -> str:
    def replaced(match: re.Match[str]) -> str:
        name = match[1]
        if name == "runner.temp":
            return str(job.temp)
        assert name.startswith("inputs."), f"the tests do not know {name}"
        return inputs[name.removeprefix("inputs.")]

    return _EXPRESSION.sub(replaced, str(value))


def _upload(job: Machine, step: Mapping[str, Any], inputs: Mapping[str, str]) -> None:
    assert step["uses"].startswith("actions/upload-artifact@")
    source = job.checkout / _text(step["with"]["path"], inputs, job)
    if source.is_dir():
        shutil.copytree(source, job.artifacts, dirs_exist_ok=True)
    elif source.is_file():
        job.artifacts.mkdir(exist_ok=True)
        shutil.copy(source, job.artifacts)


def _end_processes(mark: str) -> None:
    """Ends the processes that a machine has started, as a runner does at the end of a job."""
    for folder in Path("/proc").iterdir():
        try:
            if mark.encode() in (folder / "environ").read_bytes():
                os.kill(int(folder.name), signal.SIGTERM)
        except (OSError, ValueError):
            continue
