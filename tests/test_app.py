from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import httpx
import pytest

from drivora_service.app import create_app
from drivora_service.cli.application.service_process import run_service
from drivora_service.errors import Conflict
from drivora_service.settings import load_settings


def test_a_data_folder_has_one_service(tmp_path: Path) -> None:
    with run_service(tmp_path, workers=1) as url:
        announced = json.loads((tmp_path / "service.json").read_text())
        assert announced["url"] == url
        with pytest.raises(Conflict, match=str(announced["pid"])):
            create_app(load_settings(data_dir=tmp_path, workers=1))
    assert not (tmp_path / "service.json").exists()
    with pytest.raises(httpx.ConnectError):
        httpx.get(url)


@pytest.mark.parametrize(
    "ending",
    [signal.SIGTERM, pytest.param(signal.SIGINT, marks=pytest.mark.slow(seconds=10))],
)
def test_signals_end_a_service_in_good_order(tmp_path: Path, ending: signal.Signals) -> None:
    options = ["--data-dir", str(tmp_path), "--port", "0", "--workers", "1"]
    process = subprocess.Popen(
        [sys.executable, "-m", "drivora_service.cli", "serve", *options],
        stderr=subprocess.PIPE,
        text=True,
    )
    while not (tmp_path / "service.json").exists():
        assert process.poll() is None
        time.sleep(0.05)
    url = json.loads((tmp_path / "service.json").read_text())["url"]
    while True:
        try:
            if httpx.get(f"{url}/readyz").is_success:
                break
        except httpx.ConnectError:
            time.sleep(0.05)
    process.send_signal(ending)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 0, err
    assert "Traceback" not in err
