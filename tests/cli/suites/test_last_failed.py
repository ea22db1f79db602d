"""The memory of what failed the last time."""

from __future__ import annotations

from pathlib import Path

import pytest

from drivora_service.cli.suites.last_failed import read_last_failed, remember_failed
from drivora_service.errors import ConfigurationError


def test_scenarios_that_the_suite_lost_are_forgotten(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    suite = Path("suite.yaml")
    remember_failed(suite, ["old", "a"], not_run=["b"])
    assert read_last_failed(suite, ["a", "b", "old"]) == {"old", "a"}
    # `old` was removed from the suite: it cannot be run again.
    assert read_last_failed(suite, ["a", "b"]) == {"a"}
    with pytest.raises(ConfigurationError, match="no scenario of suite"):
        read_last_failed(suite, ["b"])
    remember_failed(suite, [], not_run=["b"])
    with pytest.raises(ConfigurationError, match="failed the last time"):
        read_last_failed(suite, ["a", "b", "old"])


def test_scenarios_that_were_not_run_stay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    suite = Path("suite.yaml")
    remember_failed(suite, ["a", "b"], not_run=[])
    remember_failed(suite, [], not_run=["b"])
    assert read_last_failed(suite, ["a", "b"]) == {"b"}
