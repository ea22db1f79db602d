"""Tokens by command, also where the file or the disk is in a bad state."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest

from drivora_service.api.guards.api_tokens import Scope, TokenFile
from drivora_service.cli.application.service_process import own_token
from tests.cli.conftest import Drivora
from tests.faults.volumes import full, small_volume

GARBLED = (b"", b"{", b"null", b'[{"name": "x"}]', b"\x00" * 100, b"\xff\xfe")


@pytest.mark.parametrize("content", GARBLED)
def test_a_garbled_file_is_named_with_what_to_do(
    drivora: Drivora, tmp_path: Path, content: bytes
) -> None:
    file = tmp_path / "data" / "tokens.json"
    file.parent.mkdir()
    file.write_bytes(content)
    for arguments in (("create", "me"), ("list",), ("revoke", "me")):
        ended = drivora("tokens", *arguments)
        assert ended.code == 2, ended
        assert str(file) in ended.err
        assert "move it away" in ended.err
        assert "Traceback" not in ended.err
        assert len(ended.err.splitlines()) == 1
    assert file.read_bytes() == content
    served = drivora("serve", "--port", "0")
    assert served.code == 2
    assert str(file) in served.err
    assert "Traceback" not in served.err


def test_a_file_of_another_account_is_named(drivora: Drivora, tmp_path: Path) -> None:
    file = tmp_path / "data" / "tokens.json"
    file.mkdir(parents=True)
    ended = drivora("tokens", "list")
    assert ended.code == 2
    assert f"{file} cannot be used: Is a directory" in ended.err


def test_the_first_and_the_last_token_are_announced(drivora: Drivora) -> None:
    first = drivora("tokens", "create", "one", "--json")
    assert "needs a token for every request from now on" in first.err
    assert first.json()["name"] == "one"
    assert drivora("tokens", "create", "two").err == ""
    assert drivora("tokens", "revoke", "one").err == ""
    assert "No token is left" in drivora("tokens", "revoke", "two").err
    refused = drivora("serve", "--port", "0")
    assert refused.code == 2
    assert "whose tokens were all revoked" in refused.err
    assert "drivora tokens create" in refused.err


def test_a_full_disk_leaves_the_tokens_as_they_were(drivora: Drivora, tmp_path: Path) -> None:
    with small_volume(tmp_path / "data", megabytes=1) as data:
        secret = drivora("tokens", "create", "kept", "--scope", "admin").out.strip()
        before = (data / "tokens.json").read_bytes()
        with full(data):
            ended = drivora("tokens", "create", "another")
            assert ended.code == 3, ended
            assert "tokens.json cannot be written: No space left on device" in ended.err
            assert "Traceback" not in ended.err
            assert ended.out == ""
            assert drivora("tokens", "revoke", "kept").code == 3
            assert (data / "tokens.json").read_bytes() == before
        assert not list(data.glob(".tokens.json.*"))
        found = TokenFile(data / "tokens.json").find(secret)
        assert found is not None
        assert found.name == "kept"
        assert drivora("tokens", "create", "another").code == 0


def command(*arguments: str | Path, data: Path, out: Path, file_bytes: int = -1) -> int:
    """Runs a command as a shell does; returns its exit code."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (file_bytes, file_bytes))

    with out.open("ab") as file:
        return subprocess.run(
            [sys.executable, "-m", "drivora_service.cli", *arguments, "--data-dir", data],
            stdout=file,
            stderr=subprocess.DEVNULL,
            preexec_fn=limit if file_bytes >= 0 else None,
            check=False,
            env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"},
        ).returncode


@pytest.mark.parametrize("file_bytes", [0, 100, 200])
def test_a_file_is_never_half_written(tmp_path: Path, file_bytes: int) -> None:
    data, out = tmp_path / "data", tmp_path / "out"
    TokenFile(data / "tokens.json").create("kept", Scope.READ)
    before = (data / "tokens.json").read_bytes()
    assert len(before) < 200
    code = command("tokens", "create", "x", data=data, out=out, file_bytes=file_bytes)
    assert code == 3
    assert (data / "tokens.json").read_bytes() == before
    assert not list(data.glob(".tokens.json.*"))


def test_a_token_that_could_not_be_shown_is_revoked(tmp_path: Path) -> None:
    data = tmp_path / "data"
    TokenFile(data / "tokens.json").create("kept", Scope.READ)
    assert command("tokens", "create", "unseen", data=data, out=Path("/dev/full")) == 3
    left = json.loads((data / "tokens.json").read_text())
    assert [token["name"] for token in left] == ["kept"]


def test_a_command_has_a_token_of_its_own_where_one_is_needed(tmp_path: Path) -> None:
    tokens = TokenFile(tmp_path / "tokens.json")
    with own_token(tmp_path) as secret:
        assert secret is None
    tokens.create("kept", Scope.READ)
    # One that a killed command has left.
    tokens.create("drivora demo", Scope.READ)
    with own_token(tmp_path) as secret:
        assert secret is not None
        found = tokens.find(secret)
        assert found is not None
        assert found.scope is Scope.ADMIN
    assert [token.name for token in tokens.all()] == ["kept"]
