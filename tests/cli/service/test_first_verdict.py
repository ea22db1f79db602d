"""The first verdict of a demo, which interpreted kernels give."""

from __future__ import annotations

from pathlib import Path

import pytest

from drivora_service.cli.service.demo_command import _write_seeds
from drivora_service.cli.service.first_verdict import describe_run, print_first_verdict


def test_interpreted_kernels_give_the_same_verdicts(
    tmp_path: Path, scenario_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    seeds = _write_seeds(tmp_path, "tee-town", 12)
    for file in (tmp_path / "seeds" / f"{next(iter(seeds))}.json", scenario_file):
        # In a process of its own, while this one calls machine code.
        print_first_verdict(file)
        out = capsys.readouterr().out
        assert out == f"first verdict: {describe_run(file)}\n"
        assert "oracles judged it, violated: " in out


def test_a_scenario_that_cannot_be_run_does_not_end_the_demo(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "broken.json"
    file.write_text("{}")
    print_first_verdict(file)
    assert "no first verdict: " in capsys.readouterr().err
