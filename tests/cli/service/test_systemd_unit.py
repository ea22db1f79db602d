"""The systemd unit with the steps of its installation, as far as a test without systemd can go."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import httpx
import pytest

from tests.api.guards.test_api_tokens import bearer
from tests.cli.conftest import Drivora
from tests.forked_service import forked_service


def environment(unit: str) -> dict[str, str]:
    """Returns the variables that the unit sets."""
    return dict(re.findall(r"^Environment=([A-Z_]+)=(.*)$", unit, re.MULTILINE))


def install_steps(page: str) -> list[list[str]]:
    """Returns the commands of the installation as a unit, as words."""
    block = page.partition("**As a systemd unit**")[2].partition("```sh\n")[2].partition("```")[0]
    return [shlex.split(line, comments=True) for line in block.splitlines()]


def test_the_service_of_the_unit_starts_with_the_steps_of_the_page(
    repository: Path, tmp_path: Path, drivora: Drivora, monkeypatch: pytest.MonkeyPatch
) -> None:
    variables = environment((repository / "deploy/systemd/drivora.service").read_text())
    folder = variables.pop("DRIVORA_DATA_DIR")
    del variables["NUMBA_CACHE_DIR"]
    assert drivora("serve", "--port", "0", **variables).code == 2
    steps = install_steps((repository / "docs/how-to/operate-the-service.md").read_text())
    (step,) = (words for words in steps if "tokens" in words)
    assert steps.index(step) < next(i for i, words in enumerate(steps) if "enable" in words)
    assert step[:4] == ["runuser", "-u", "drivora", "--"]
    assert step[4] == "/opt/drivora/.venv/bin/drivora"
    assert folder in step
    data = tmp_path / "unit-data"
    made = drivora(*(str(data) if word == folder else word for word in step[5:]), **variables)
    assert made.code == 0, made.err
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    with forked_service(data, workers=1) as url:
        jobs = f"{url}/api/v1/jobs"
        assert httpx.get(jobs).status_code == 401
        assert httpx.get(jobs, headers=bearer(made.out.strip())).status_code == 200
