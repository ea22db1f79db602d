"""``drivora examples``."""

from __future__ import annotations

from pathlib import Path

from typer.testing import CliRunner

from drivora_service.cli.main import app

_FILES = ("walker-behind-van.json", "campaigns/deadlock.yaml", "suites/smoke/suite.yaml")


def test_it_lists_scenarios_campaigns_and_suites() -> None:
    done = CliRunner().invoke(app, ["examples"])
    assert done.exit_code == 0
    assert set(_FILES) < set(done.stdout.splitlines())


def test_it_copies_them_and_replaces_nothing(tmp_path: Path, repository: Path) -> None:
    out = tmp_path / "examples"
    done = CliRunner().invoke(app, ["examples", "--out", str(out)])
    assert done.exit_code == 0
    copies = set(done.stdout.splitlines())
    assert copies == {str(path) for path in out.rglob("*") if path.is_file()}
    assert {str(out / name) for name in _FILES} < copies
    shipped = repository / "openscenario_schemas" / "examples"
    assert (out / _FILES[0]).read_bytes() == (shipped / _FILES[0]).read_bytes()

    (out / _FILES[0]).write_text("mine")
    again = CliRunner().invoke(app, ["examples", "--out", str(out)])
    assert again.exit_code != 0
    assert (out / _FILES[0]).read_text() == "mine"
