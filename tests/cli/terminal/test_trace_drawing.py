"""Which oracles judge a trace that is drawn."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from drivora_service.cli.terminal.trace_drawing import draw_trace
from drivora_service.errors import OracleError, UnknownName
from drivora_service.observations.trace_files.trace_file import write_trace
from drivora_service.settings import Settings
from drivora_service.testing.traces import Motion, SyntheticEgo, make_trace
from tests.oracles.installing import install_oracles


def test_oracles_of_packages_judge_what_is_drawn_if_they_are_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_oracles(tmp_path / "site", monkeypatch, "top_speed", "unmade")
    ego = SyntheticEgo(motion=Motion.steady(139.0, 149.0, steps=40, speed=9.0))
    path, picture = tmp_path / "run.parquet", tmp_path / "run.svg"
    write_trace(replace(make_trace([ego]), network="tee-town"), path)
    settings = Settings(data_dir=tmp_path / "data")

    def drawn(*oracles: str) -> str:
        draw_trace(path, settings, picture, oracles=oracles)
        return picture.read_text()

    assert len(drawn("top_speed")) > len(drawn("red_light"))
    picture.unlink()
    with pytest.raises(OracleError, match="oracle 'unmade' of the package 'foreign-oracles'"):
        drawn()
    with pytest.raises(UnknownName, match="top_speed, unmade"):
        drawn("crash")
    assert not picture.exists()
