from __future__ import annotations

import os
import stat
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import httpx
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.api.guards.api_tokens import Scope, TokenFile
from drivora_service.app import create_app
from drivora_service.errors import ConfigurationError, CredentialsUnusable, UnknownName
from drivora_service.settings import load_settings
from tests.api.conftest import MakeOffline
from tests.api.test_problem_details import is_problem
from tests.forked_service import forked_service


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


def _replace_by_pipe(path: Path) -> None:
    os.mkfifo(path)


def _replace_by_device(path: Path) -> None:
    path.symlink_to("/dev/zero")


def _replace_by_folder(path: Path) -> None:
    path.mkdir()


def _replace_by_link_to_nothing(path: Path) -> None:
    path.symlink_to(path.parent / "not-mounted" / "tokens.json")


def _replace_by_large_file(path: Path) -> None:
    path.touch()
    os.truncate(path, 1 << 32)


@pytest.mark.parametrize(
    ("replace", "expected"),
    [
        (_replace_by_pipe, "a pipe"),
        (_replace_by_device, "a device"),
        (_replace_by_folder, "directory"),
        (_replace_by_link_to_nothing, "a link to a file that does not exist"),
        (_replace_by_large_file, "4294967296 bytes"),
    ],
)
def test_what_is_no_usual_file_closes_the_service_and_is_not_waited_for(
    tmp_path: Path, replace: Callable[[Path], None], expected: str
) -> None:
    replace(tmp_path / "tokens.json")
    tokens = TokenFile(tmp_path / "tokens.json", always_needed=False)
    assert tokens.are_needed
    assert expected in tokens.fault
    with pytest.raises(CredentialsUnusable):
        tokens.find("anything")
    with pytest.raises(CredentialsUnusable):
        tokens.create("me", Scope.READ)


def test_a_damaged_file_makes_a_service_not_ready(tmp_path: Path) -> None:
    data = tmp_path / "data"
    tokens = TokenFile(data / "tokens.json")
    secret = tokens.create("me", Scope.ADMIN)
    good = (data / "tokens.json").read_bytes()
    with (
        forked_service(data, workers=1) as url,
        httpx.Client(base_url=url, timeout=30, headers=bearer(secret)) as client,
    ):
        assert client.get("/api/v1/jobs").status_code == 200
        # On loopback, too.
        is_problem(httpx.get(f"{url}/api/v1/jobs"), 401)
        (data / "tokens.json").write_bytes(good[:-20])
        for _ in range(3):
            refused = is_problem(client.get("/api/v1/jobs"), 503)
            assert "API tokens" in refused["detail"]
            assert str(data) not in refused["detail"]
            assert is_problem(client.get("/metrics"), 503)
            is_problem(client.post("/api/v1/session", json={"token": secret}), 503)
        ready = client.get("/readyz")
        assert ready.status_code == 503
        (check,) = (one for one in ready.json()["checks"] if not one["ok"])
        assert check["name"] == "tokens"
        assert "tokens.json cannot be used" in check["detail"]
        assert "move it away" in check["detail"]
        assert client.get("/healthz").status_code == 200
        (data / "tokens.json").write_bytes(good)
        assert client.get("/readyz").status_code == 200
        assert client.get("/api/v1/jobs").status_code == 200
    log = (data / "service.log").read_text()
    assert log.count("credentials_unusable") == 1
    assert "Traceback" not in log


def test_a_service_without_tokens_says_so_once(tmp_path: Path) -> None:
    data = tmp_path / "data"
    with forked_service(data, workers=1) as url:
        assert httpx.get(f"{url}/api/v1/jobs").status_code == 200
        secret = TokenFile(data / "tokens.json").create("me", Scope.READ)
        is_problem(httpx.get(f"{url}/api/v1/jobs"), 401)
        assert httpx.get(f"{url}/api/v1/jobs", headers=bearer(secret)).status_code == 200
    log = (data / "service.log").read_text()
    assert log.count("no_api_tokens") == 1
    assert "drivora tokens create NAME" in log


def test_tokens_that_change_at_once_are_all_kept(tmp_path: Path) -> None:
    files = [TokenFile(tmp_path / "tokens.json") for _ in range(4)]

    def create(number: int) -> str:
        return files[number % 4].create(f"token-{number}", Scope.READ)

    with ThreadPoolExecutor(8) as pool:
        secrets = [*pool.map(create, range(24))]
    assert len(files[0].all()) == 24
    assert all(files[1].find(secret) is not None for secret in secrets)


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


def test_tokens_that_were_all_revoked_are_no_open_door(tmp_path: Path) -> None:
    tokens = TokenFile(tmp_path / "tokens.json", always_needed=False)
    tokens.create("me", Scope.READ)
    assert tokens.are_needed
    tokens.revoke("me")
    assert tokens.are_needed
    with pytest.raises(ConfigurationError, match="all revoked"):
        create_app(load_settings(host="127.0.0.1", data_dir=tmp_path))
    (tmp_path / "tokens.json").unlink()
    assert tokens.are_needed
    assert not TokenFile(tmp_path / "tokens.json", always_needed=False).are_needed


def test_required_tokens_must_exist(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="DRIVORA_REQUIRE_TOKENS needs API tokens"):
        create_app(load_settings(host="127.0.0.1", data_dir=tmp_path, require_tokens=True))
