"""What the process of an ADS cannot do, tried by one."""

from __future__ import annotations

import contextlib
import json
import os
import pwd
import resource
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.manifest_files import FILE_NAME
from drivora_service.agents.remote.confinement import Confinement, variables_for
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.errors import AgentError, ConfigurationError
from drivora_service.scenario.model import AgentChoice, Scenario
from drivora_service.settings import Settings
from drivora_service.worker_settings import worker_setup
from tests.simulation.episodes import ego, place, run, scenario

NOBODY = "nobody"
needs_root = pytest.mark.skipif(
    os.geteuid() != 0, reason="only root can start processes under another account"
)


@pytest.fixture
def home() -> Iterator[Path]:
    """A folder that other accounts can pass through, unlike those of pytest."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o755)
        yield Path(folder)


def interpreter_for(account: pwd.struct_passwd) -> str:
    """An interpreter of this version that another account may run."""
    name = f"python{sys.version_info.major}.{sys.version_info.minor}"
    for candidate in (sys.executable, f"/usr/bin/{name}", f"/usr/local/bin/{name}"):
        with contextlib.suppress(OSError):
            subprocess.run(
                [candidate, "-c", ""],
                user=account.pw_uid, group=account.pw_gid, extra_groups=[], check=True,
            )  # fmt: skip
            return candidate
    pytest.skip(f"{account.pw_name} may run no interpreter of this version")


def probe(
    home: Path, confinement: Confinement, *, python: str = "{python}", **parameters: object
) -> dict[str, Any]:
    """Runs the prober; gives what it found."""
    agents, data = home / "agents", home / "data"
    (agents / "prober").mkdir(parents=True)
    shutil.copy(Path(__file__).with_name("prober.py"), agents / "prober")
    data.mkdir(mode=0o700)
    (data / "tokens.json").write_text("{}")
    manifest = {
        "name": "prober",
        "kind": "baseline",
        "description": "tries what it must not",
        "source": "tests",
        "licence": "Apache-2.0",
        "command": [python, "{folder}/prober.py"],
        "variables": {"PYTHONPATH": sysconfig.get_path("purelib")},
    }
    (agents / "prober" / FILE_NAME).write_text(yaml.safe_dump(manifest))
    catalogue = AgentCatalogue(folder=agents, confinement=confinement)
    try:
        agent = catalogue.create("prober", {})
        assert not isinstance(agent, SumoDriver)
        told = {"secret": str(data / "tokens.json"), "service": os.getpid(), **parameters}
        trace = run(_drive(told), agent)
    finally:
        catalogue.close()
    assert sorted(path.name for path in data.iterdir()) in (
        ["tokens.json"],
        ["planted", "tokens.json"],
    )
    found: dict[str, Any] = json.loads(trace.log_events[0].message)
    return found


def _drive(parameters: dict[str, Any]) -> Scenario:
    start, end = place("harbour_1_0", 20), place("harbour_1_0", 120)
    driver = replace(ego(start, end), agent=AgentChoice(name="prober", parameters=parameters))
    return scenario(driver, seconds=0.2)


@needs_root
def test_an_ads_under_its_own_account_cannot_touch_the_service(
    home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DRIVORA_DATABASE_URL", "postgresql://user:secret@db/drivora")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "secret")
    account = pwd.getpwnam(NOBODY)
    confined = Confinement(user=account.pw_uid, group=account.pw_gid, file_bytes=1 << 20)
    found = probe(home, confined, python=interpreter_for(account))
    assert found["user"] == account.pw_uid
    assert found["child"] == str(account.pw_uid)
    assert found["groups"] in ([], [account.pw_gid])
    for what in ("read", "list", "write", "write_own_code", "signal", "environment"):
        assert found[what] == "PermissionError", what
    assert found["scratch"] == "done"
    assert found["big_file"] == "OSError"
    assert "secret" not in json.dumps(found["variables"])
    assert found["variables"]["HOME"] == found["variables"]["TMPDIR"]
    assert found["no_new_privileges"]
    assert found["core"] == [0, 0]
    assert found["processes"] == [4096, 4096]


def test_an_ads_under_the_account_of_the_service_has_limits(
    home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DRIVORA_DATABASE_URL", "postgresql://user:secret@db/drivora")
    monkeypatch.setenv("PGPASSWORD", "secret")
    found = probe(home, Confinement(file_bytes=1 << 20, files=300))
    assert found["user"] == os.getuid()
    assert found["scratch"] == "done"
    assert found["big_file"] == "OSError"
    assert "secret" not in json.dumps(found["variables"])
    assert found["no_new_privileges"]
    assert found["core"] == [0, 0]
    assert found["files"] == [300, 300]
    assert found["processes"] == list(resource.getrlimit(resource.RLIMIT_NPROC))


def test_an_ads_that_outgrows_its_memory_is_ended_and_its_log_says_so(home: Path) -> None:
    with pytest.raises(AgentError) as failure:
        probe(home, Confinement(memory_bytes=300 << 20), eat=True)
    assert failure.value.cause == "agent_died"
    assert "MiB of memory; allowed: 300 MiB" in failure.value.log


def test_the_operator_names_the_variables_that_an_ads_gets_besides() -> None:
    own = {"PATH": "/bin", "LC_ALL": "C", "DRIVORA_KEY": "k", "DRIVORA_DATABASE_URL": "u", "X": "1"}
    passed = variables_for(own, scratch=Path("/s"), settings=("DRIVORA_KEY",))
    assert passed == {"PATH": "/bin", "LC_ALL": "C", "DRIVORA_KEY": "k", "TMPDIR": "/s"}


def test_an_account_that_does_not_exist_is_refused(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path, agent_user="no-such-account")
    with pytest.raises(ConfigurationError, match="no account of this machine"):
        worker_setup(settings)


@needs_root
def test_folders_that_would_not_do_are_refused(tmp_path: Path) -> None:
    agents = tmp_path / "agents"
    data = tmp_path / "data"
    data.mkdir(mode=0o755)
    with pytest.raises(ConfigurationError, match="set DRIVORA_AGENTS_DIR"):
        worker_setup(Settings(data_dir=data, agent_user=NOBODY))
    with pytest.raises(ConfigurationError, match="chmod 700"):
        worker_setup(Settings(data_dir=data, agents_dir=agents, agent_user=NOBODY))
    with pytest.raises(ConfigurationError, match="the account of the service"):
        worker_setup(Settings(data_dir=data, agents_dir=agents, agent_user="root"))
    data.chmod(0o700)
    made = worker_setup(Settings(data_dir=data, agents_dir=agents, agent_user=NOBODY))
    assert made.confinement.user == pwd.getpwnam(NOBODY).pw_uid
