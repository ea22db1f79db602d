"""Commands where packages bring oracles."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.conftest import Drivora
from tests.oracles.installing import install_oracles

EXAMPLE = "walker-behind-van"


def test_installed_oracles_judge_and_are_drawn(
    drivora: Drivora, repository: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_oracles(tmp_path / "site", monkeypatch, "top_speed")
    scenario = repository / "openscenario_schemas" / "examples" / f"{EXAMPLE}.json"
    result = drivora("run", scenario, "--out", tmp_path, "--json").json()
    assert result["verdicts"][-1]["oracle"] == "top_speed"
    assert result["verdicts"][-1]["outcome"] == "violated"

    def picture(*rules: str) -> str:
        options = [part for rule in rules for part in ("--rule", rule)]
        trace, target = tmp_path / f"{EXAMPLE}.trace.parquet", tmp_path / "run.svg"
        drawn = drivora("plot", trace, "--out", target, *options)
        assert drawn.code == 0, drawn.err
        return target.read_text()

    assert len(picture("top_speed")) > len(picture("red_light"))


def test_an_oracle_that_cannot_be_loaded_is_told_of(
    drivora: Drivora, repository: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario = repository / "openscenario_schemas" / "examples" / f"{EXAMPLE}.json"
    assert drivora("run", scenario, "--out", tmp_path).code == 0
    install_oracles(tmp_path / "site", monkeypatch, "unmade")
    ended = drivora("run", scenario)
    assert ended.code == 3
    assert "oracle_plugin: oracle 'unmade' of the package 'foreign-oracles'" in ended.out
    trace = tmp_path / f"{EXAMPLE}.trace.parquet"
    drawn = drivora("plot", trace, "--out", tmp_path / "run.svg")
    assert drawn.code == 3
    assert "oracle 'unmade' of the package 'foreign-oracles'" in drawn.err
    named = drivora("plot", trace, "--out", tmp_path / "run.svg", "--rule", "collision")
    assert named.code == 0, named.err
