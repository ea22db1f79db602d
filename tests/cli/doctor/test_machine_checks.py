"""The checks of kernels and of the environment."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from drivora_service.cli.doctor.findings import Check, State, ok, perform_checks
from drivora_service.cli.doctor.machine_checks import check_environment, check_kernels, check_speed
from drivora_service.cli.doctor.software_checks import check_command


def test_kernels_that_are_not_compiled_are_a_note(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kernels"))
    (found,) = check_kernels()
    assert found.state is State.NOTE
    (speed,) = check_speed()
    assert speed.state is State.NOTE
    (tmp_path / "kernels" / "motion").mkdir(parents=True)
    (tmp_path / "kernels" / "motion" / "step_kernels.make_frame-95.py311.1.nbc").touch()
    (compiled,) = check_kernels()
    assert (compiled.state, compiled.found) == (
        State.OK,
        f"compiled: 1 in {tmp_path / 'kernels'}",
    )


def test_kernels_that_cannot_be_kept_are_a_problem(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file"))
    _, found = check_kernels()
    assert found.state is State.PROBLEM


def test_variables_are_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in os.environ if name.startswith(("DRIVORA_", "NUMBA_"))]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    monkeypatch.setenv("NUMBA_OPT", "0")
    monkeypatch.setenv("DRIVORA_DILU_API_KEY", "sk-hidden")
    monkeypatch.setenv("DRIVORA_DATA_DIRECTORY", "x")
    found = [*check_environment()]
    assert [one.state for one in found] == [State.PROBLEM, State.NOTE, State.NOTE, State.OK]
    assert found[0].remedy == "Did you mean DRIVORA_DATA_DIR?"
    assert "sk-hidden" not in str(found)
    assert "DRIVORA_DILU_API_KEY (set)" in found[-1].found


def test_another_command_of_the_name_is_noticed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = tmp_path / "drivora"
    other.write_text("#!/bin/sh\n")
    other.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    found = [*check_command()][-1]
    assert found.state in (State.NOTE, State.PROBLEM)
    assert str(other) in found.found or "does not exist" in found.found


def test_a_check_that_raises_is_a_problem_of_its_subject() -> None:
    def fail() -> list[object]:
        raise SystemExit(4)

    found = perform_checks([Check("first", fail), Check("second", lambda: [ok("second", "fine")])])  # type: ignore[arg-type]  # never returns
    assert [(one.subject, one.state) for one in found] == [
        ("first", State.PROBLEM),
        ("second", State.OK),
    ]
