from __future__ import annotations

import json
import logging
from pathlib import Path

import pytest
import structlog
from sqlalchemy import create_engine

from drivora_service.logs import configure_logs
from drivora_service.store.migration import upgrade


def test_own_and_foreign_lines_are_json_alike(capsys: pytest.CaptureFixture[str]) -> None:
    configure_logs(form="json", level="info")
    structlog.stdlib.get_logger("drivora.test").info("run_ended", run="7")
    logging.getLogger("uvicorn.error").warning("slow", extra={"color_message": "\x1b[1mslow"})
    logging.getLogger("elsewhere").debug("unseen")
    own, foreign = (json.loads(line) for line in capsys.readouterr().err.splitlines())
    assert (own["event"], own["run"], own["level"]) == ("run_ended", "7", "info")
    assert (foreign["event"], foreign["logger"]) == ("slow", "uvicorn.error")
    assert "color_message" not in foreign


def test_a_migration_tells_its_revisions_only(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    configure_logs(form="json")
    engine = create_engine(f"sqlite:///{tmp_path / 'd.sqlite3'}")
    upgrade(engine, "0002")
    engine.dispose()
    events = [json.loads(line)["event"] for line in capsys.readouterr().err.splitlines()]
    assert any(one.startswith("Running upgrade 0001 -> 0002") for one in events)
    assert not [one for one in events if "plugin" in one]


def test_errors_carry_their_trace(capsys: pytest.CaptureFixture[str]) -> None:
    configure_logs(form="json")
    _fail()
    assert "ValueError: broken" in json.loads(capsys.readouterr().err)["exception"]


def test_no_log_shows_the_values_of_variables(capsys: pytest.CaptureFixture[str]) -> None:
    for form in ("console", "json"):
        configure_logs(form=form)
        _fail()
    said = capsys.readouterr().err
    assert said.count("ValueError: broken") == 2
    assert "drv_secret" not in said


def _fail() -> None:
    token = "drv_" + "secret"
    try:
        raise ValueError("broken")
    except ValueError as error:
        structlog.stdlib.get_logger("t").error("failed", size=len(token), exc_info=error)


def test_console_lines_are_plain_without_a_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    configure_logs(form="console")
    structlog.stdlib.get_logger("t").info("ready", workers=2)
    line = capsys.readouterr().err
    assert "ready" in line
    assert "\x1b" not in line
