from __future__ import annotations

import sys
from pathlib import Path

import pytest

from benchmarks.suite.environments import Answer, PeerError, prepare_environment, start_peer

_ANSWERS = """
import json, sys
for number, _ in enumerate(sys.stdin):
    print(json.dumps({"simulated": 60.0, "needed": 2.0 + number, "vehicles": 3}), flush=True)
"""
_FAILS = """
import sys
sys.stdin.readline()
raise SystemExit("its data are not there")
"""


def test_a_peer_answers_each_round(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(_ANSWERS)
    with start_peer(Path(sys.executable), script, (), tmp_path / "log") as one:
        assert one.run_round() == Answer(simulated=60.0, needed=2.0, vehicles=3)
        assert one.run_round().times_real == 20.0


def test_a_peer_that_fails_says_why(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(_FAILS)
    with (
        start_peer(Path(sys.executable), script, (), tmp_path / "log") as one,
        pytest.raises(PeerError, match="it failed: its data are not there"),
    ):
        one.run_round()


def test_an_environment_is_not_installed_unasked(tmp_path: Path) -> None:
    requirements = tmp_path / "nothing.txt"
    requirements.write_text("")
    with pytest.raises(PeerError, match="the short form installs nothing"):
        prepare_environment(requirements, tmp_path / "cache", install=False)
    assert not (tmp_path / "cache").exists()


@pytest.mark.slow(seconds=10)
def test_an_environment_is_installed_once(tmp_path: Path) -> None:
    requirements = tmp_path / "nothing.txt"
    requirements.write_text("")
    python = prepare_environment(requirements, tmp_path / "cache", install=True)
    assert python.is_file()
    assert prepare_environment(requirements, tmp_path / "cache", install=False) == python


@pytest.mark.slow(seconds=10)
def test_what_cannot_be_installed_is_said_and_tried_again(tmp_path: Path) -> None:
    requirements = tmp_path / "wrong.txt"
    requirements.write_text("./no-such-package\n")
    for _ in range(2):
        with pytest.raises(PeerError, match="it cannot be installed: "):
            prepare_environment(requirements, tmp_path / "cache", install=True)
