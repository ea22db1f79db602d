from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import httpx
import pytest

from drivora_service.app import _engine_setup, create_app
from drivora_service.campaigns.hosts.engine_limits import EngineLimits
from drivora_service.errors import Conflict
from drivora_service.settings import load_settings
from tests.forked_service import begin_service, wait_until_ready


def test_a_data_folder_has_one_service_that_a_signal_ends_in_good_order(tmp_path: Path) -> None:
    options = ["--data-dir", str(tmp_path), "--port", "0", "--workers", "1"]
    process = subprocess.Popen(
        [sys.executable, "-m", "drivora_service.cli", "serve", *options],
        stderr=subprocess.PIPE,
        text=True,
    )
    while not (tmp_path / "service.json").exists():
        assert process.poll() is None
        time.sleep(0.05)
    announced = json.loads((tmp_path / "service.json").read_text())
    url = announced["url"]
    while True:
        try:
            if httpx.get(f"{url}/readyz").is_success:
                break
        except httpx.ConnectError:
            time.sleep(0.05)
    assert announced["pid"] == process.pid
    with pytest.raises(Conflict, match=str(process.pid)):
        create_app(load_settings(data_dir=tmp_path, workers=1))
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 0, err
    assert "Traceback" not in err
    assert not (tmp_path / "service.json").exists()
    with pytest.raises(httpx.ConnectError):
        httpx.get(url)


@pytest.mark.slow
def test_an_interrupt_ends_a_service_in_good_order(tmp_path: Path) -> None:
    begun = begin_service(tmp_path, workers=1)
    wait_until_ready(begun, tmp_path)
    begun.send_signal(signal.SIGINT)
    log = tmp_path / "service.log"
    assert begun.wait(30) == 0, log.read_text()
    assert "Traceback" not in log.read_text()


def test_campaigns_have_the_limits_of_the_settings(tmp_path: Path) -> None:
    settings = load_settings(data_dir=tmp_path, campaign_memory_mb=600, tester_deadline_s=7.0)
    assert _engine_setup(settings).limits == EngineLimits(memory_bytes=600 << 20, call_s=7.0)
    unset = load_settings(data_dir=tmp_path)
    assert _engine_setup(unset).limits == EngineLimits()
