"""Requests made from the OpenAPI document, against a real service with real workers.

``DRIVORA_FUZZ_SECONDS`` sets how long each of the two runs of schemathesis takes (by default 8),
and ``DRIVORA_FUZZ_SEED`` another seed.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import httpx
import pytest

from drivora_service.api.documentation.recorded_examples import CAMPAIGN, SCENARIO
from drivora_service.api.guards.api_tokens import Scope, TokenFile
from tests.forked_service import forked_service

pytestmark = pytest.mark.slow(seconds=20)

PREFIX = "/api/v1"
SECONDS = os.environ.get("DRIVORA_FUZZ_SECONDS", "8")
SEED = os.environ.get("DRIVORA_FUZZ_SEED", "1")

REFUSES = (
    "/jobs|/networks|/batches|/campaigns|/studies|/suite-runs|/failures/groups|:validate|:compare"
)
CONFIG = f"""
[cache]
enabled = false

[generation]
database = "none"

[warnings]
enabled = false

# A document that its schema accepts may still be off the road or name what there is not, campaigns
# may not be comparable, a decision may contradict its outcomes, and a baseline is a time or an id.
[[operations]]
include-path-regex = "({REFUSES})$"

[operations.checks.positive_data_acceptance]
expected-statuses = ["2xx", "401", "403", "404", "409", "422", "429", "503"]
"""


def schemathesis(
    repository: Path, folder: Path, url: str, options: Sequence[str] = ()
) -> subprocess.CompletedProcess[str]:
    """Runs all phases with all checks; ends with 0 if nothing was found."""
    config = folder / "schemathesis.toml"
    config.write_text(CONFIG)
    command = [sys.executable, "-m", "schemathesis.cli", "--config-file", str(config), "run"]
    command += [f"{url}{PREFIX}/openapi.json", "--checks", "all", "--seed", SEED]
    # A stream of events does not end.
    command += ["--exclude-path-regex", "/events$"]
    command += ["--max-time", SECONDS, "--generation-deterministic", "--no-color", *options]
    environment = {**os.environ, "SCHEMATHESIS_HOOKS": "tests.fuzzing.api_hooks"}
    environment["PYTHONPATH"] = str(repository)
    return subprocess.run(
        command, cwd=repository, env=environment, capture_output=True, text=True, check=False
    )


def judge_a_run(client: httpx.Client) -> None:
    """Posts a run and waits for its end."""
    posted = client.post(f"{PREFIX}/jobs", json=SCENARIO).raise_for_status()
    wait_for(client, posted.headers["Location"], "status")


def fill(client: httpx.Client) -> None:
    """Posts what the operations that only look need, and waits for it."""
    judge_a_run(client)
    campaign = {**CAMPAIGN, "budget": {"simulations": 8}, "oracles": ["collision", "discomfort"]}
    posted = client.post(f"{PREFIX}/campaigns", json=campaign).raise_for_status()
    wait_for(client, posted.headers["Location"], "state")


def wait_for(client: httpx.Client, url: str, key: str) -> None:
    """Waits until what is posted is finished."""
    deadline = time.monotonic() + 300
    while (found := client.get(url).json())[key] != "finished":
        assert time.monotonic() < deadline, found
        time.sleep(0.2)


def check(done: subprocess.CompletedProcess[str], url: str, headers: dict[str, str]) -> None:
    """Nothing was found, the service lives, and takes and ends runs."""
    assert done.returncode == 0, done.stdout[-20_000:] + done.stderr[-2_000:]
    with httpx.Client(base_url=url, headers=headers, timeout=60) as client:
        assert client.get("/healthz").status_code == 200
        # The campaigns that the requests have posted may take longer than this test.
        judge_a_run(client)


def test_nothing_is_found_without_tokens(repository: Path, tmp_path: Path) -> None:
    data = tmp_path / "data"
    with forked_service(data, workers=1) as url:
        with httpx.Client(base_url=url, timeout=60) as client:
            fill(client)
        check(schemathesis(repository, tmp_path, url), url, {})
    assert "Traceback" not in (data / "service.log").read_text()


def test_nothing_is_found_where_tokens_are_needed(
    repository: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DRIVORA_REQUIRE_TOKENS", "true")
    data = tmp_path / "data"
    secret = TokenFile(data / "tokens.json").create("fuzzer", Scope.ADMIN)
    headers = {"Authorization": f"Bearer {secret}"}
    with forked_service(data, workers=1) as url:
        with httpx.Client(base_url=url, headers=headers, timeout=60) as client:
            fill(client)
            assert httpx.get(f"{url}{PREFIX}/jobs").status_code == 401
        options = ("--header", f"Authorization: Bearer {secret}")
        check(schemathesis(repository, tmp_path, url, options), url, headers)
    assert "Traceback" not in (data / "service.log").read_text()
