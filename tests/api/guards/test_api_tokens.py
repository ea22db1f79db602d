from __future__ import annotations

import stat
from pathlib import Path

import httpx
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.api.guards.api_tokens import Scope, TokenFile
from drivora_service.app import create_app
from drivora_service.errors import ConfigurationError, UnknownName
from drivora_service.settings import load_settings
from tests.api.conftest import MakeOffline


def bearer(secret: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {secret}"}


def test_only_hashes_are_kept_and_only_for_the_owner(tmp_path: Path) -> None:
    path = tmp_path / "tokens.json"
    secret = TokenFile(path).create("ci", Scope.SUBMIT)
    assert secret not in path.read_text()
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    found = TokenFile(path).find(secret)
    assert found is not None
    assert (found.name, found.scope) == ("ci", Scope.SUBMIT)
    assert TokenFile(path).find(secret[:-1]) is None


def test_names_are_unique_and_must_exist(tmp_path: Path) -> None:
    tokens = TokenFile(tmp_path / "tokens.json")
    tokens.create("ci", Scope.READ)
    with pytest.raises(ConfigurationError):
        tokens.create("ci", Scope.ADMIN)
    with pytest.raises(UnknownName):
        tokens.revoke("cd")


def test_a_damaged_file_is_an_error_rather_than_an_open_door(tmp_path: Path) -> None:
    path = tmp_path / "tokens.json"
    path.write_text("{")
    with pytest.raises(ConfigurationError):
        TokenFile(path).find("anything")


def test_scopes_open_what_they_should(make_offline: MakeOffline, tmp_path: Path) -> None:
    tokens = TokenFile(tmp_path / "tokens.json")
    viewer, sender = tokens.create("viewer", Scope.READ), tokens.create("sender", Scope.SUBMIT)
    client = make_offline(tokens=tokens).client

    def post(headers: dict[str, str]) -> httpx.Response:
        return client.post("/api/v1/jobs", json=SCENARIO, headers=headers)

    anonymous = client.get("/api/v1/jobs")
    assert anonymous.status_code == 401
    assert anonymous.headers["WWW-Authenticate"] == "Bearer"
    assert client.get("/api/v1/jobs", headers=bearer("drv_guess")).status_code == 401
    assert client.get("/api/v1/jobs", headers=bearer(viewer)).status_code == 200
    assert post(bearer(viewer)).status_code == 403
    assert post(bearer(sender)).status_code == 202
    assert client.get("/metrics").status_code == 401
    assert client.get("/healthz").status_code == 200
    tokens.revoke("sender")
    assert post(bearer(sender)).status_code == 401


def test_a_service_beyond_loopback_refuses_to_start_without_tokens(tmp_path: Path) -> None:
    settings = load_settings(host="0.0.0.0", data_dir=tmp_path)
    with pytest.raises(ConfigurationError, match="drivora tokens create"):
        create_app(settings)
