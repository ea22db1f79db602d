"""Loads the real libsumo, with a library that the loader really cannot use."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from drivora_service.system_libraries import PACKAGES, install_commands, remedy

_MODULE = "drivora_service.system_libraries"


def programs(folder: Path, *names: str, script: str = "exit 0") -> str:
    """Writes programs and returns the PATH on which only they are."""
    folder.mkdir(exist_ok=True)
    for name in names:
        (folder / name).write_text(f"#!/bin/sh\n{script}\n")
        (folder / name).chmod(0o755)
    return str(folder)


def broken_libraries(folder: Path, *names: str) -> Path:
    """Makes a folder in which the loader finds files that are no libraries."""
    folder.mkdir()
    for name in names:
        (folder / name).touch()
    return folder


def check(repository: Path, libraries: Path, path: str) -> subprocess.CompletedProcess[str]:
    """Runs the check of ``make install`` where some libraries cannot be loaded."""
    environment = {**os.environ, "LD_LIBRARY_PATH": str(libraries), "PATH": path}
    return subprocess.run(
        [sys.executable, "-m", _MODULE],
        cwd=repository,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


def test_root_on_debian_may_install_the_packages_of_what_is_missing(tmp_path: Path) -> None:
    path = programs(tmp_path / "bin", "dnf", "apt-get")
    found = remedy(["libX11.so.6", "libGL.so.1"], path=path, is_root=True)
    assert found.allowed
    assert found.commands[-1][-2:] == ("libx11-6", "libgl1")
    assert found.line == (
        "apt-get update && apt-get install --yes --no-install-recommends libx11-6 libgl1"
    )


def test_other_users_get_one_line_that_a_shell_understands(tmp_path: Path) -> None:
    found = remedy(["libX11.so.6"], path=programs(tmp_path / "bin", "apt-get"), is_root=False)
    assert not found.allowed
    assert found.line.startswith("sudo sh -c ")
    fakes = programs(tmp_path / "fakes", "apt-get", script=f'echo "$@" >> {tmp_path / "said"}')
    sudo = programs(tmp_path / "fakes", "sudo", script='exec "$@"')
    subprocess.run(
        [shutil.which("sh") or "/bin/sh", "-c", found.line],
        env={"PATH": f"{fakes}:{sudo}:{os.environ['PATH']}"},
        check=True,
    )
    assert (tmp_path / "said").read_text().splitlines() == [
        "update",
        "install --yes --no-install-recommends libx11-6",
    ]


def test_rpm_systems_are_asked_for_the_libraries_themselves(tmp_path: Path) -> None:
    found = remedy(["libGL.so.1"], path=programs(tmp_path / "bin", "dnf"), is_root=True)
    assert found.commands == (("dnf", "install", "--assumeyes", "libGL.so.1()(64bit)"),)
    assert found.line == "dnf install --assumeyes 'libGL.so.1()(64bit)'"


def test_a_system_without_a_known_package_manager_is_told_what_is_missing(tmp_path: Path) -> None:
    found = remedy(list(PACKAGES), path=programs(tmp_path / "bin", "pkg"), is_root=True)
    assert (found.commands, found.allowed) == ((), False)
    assert all(library in found.line for library in PACKAGES)


def test_nothing_is_said_where_libsumo_can_be_imported(repository: Path, tmp_path: Path) -> None:
    done = check(repository, broken_libraries(tmp_path / "none"), os.environ["PATH"])
    assert (done.returncode, done.stderr) == (0, "")


def test_an_installation_that_may_not_install_stops_and_says_why(
    repository: Path, tmp_path: Path
) -> None:
    libraries = broken_libraries(tmp_path / "broken", "libXrender.so.1", "libatomic.so.1")
    done = check(repository, libraries, programs(tmp_path / "bin", "pkg"))
    assert done.returncode == 1
    assert "install libXrender.so.1, libatomic.so.1 with the package manager" in done.stderr
    assert "make install" in done.stderr


@pytest.mark.skipif(os.geteuid() != 0, reason="only root installs packages")
@pytest.mark.parametrize("manager", ["apt-get", "dnf"])
def test_root_installs_what_is_missing_and_tries_again(
    repository: Path, tmp_path: Path, manager: str
) -> None:
    libraries = broken_libraries(tmp_path / "broken", "libXrender.so.1", "libGL.so.1")
    said = tmp_path / "said"
    remove = shutil.which("rm")
    fake = programs(
        tmp_path / "bin", manager, script=f'echo "$@" >> {said}\n{remove} -f {libraries}/*'
    )
    done = check(repository, libraries, fake)
    assert done.returncode == 0, done.stderr
    wanted = install_commands(manager, ["libXrender.so.1", "libGL.so.1"])
    assert said.read_text().splitlines() == [" ".join(command[1:]) for command in wanted]


@pytest.mark.skipif(os.geteuid() != 0, reason="only root installs packages")
@pytest.mark.parametrize(("script", "found"), [("exit 100", "100"), ("exit 0", "still cannot")])
def test_an_installation_that_does_not_help_is_no_success(
    repository: Path, tmp_path: Path, script: str, found: str
) -> None:
    libraries = broken_libraries(tmp_path / "broken", "libX11.so.6")
    done = check(repository, libraries, programs(tmp_path / "bin", "apt-get", script=script))
    assert done.returncode == 1
    assert found in done.stderr


def test_make_install_checks_that_libsumo_can_be_imported(repository: Path) -> None:
    command = ["make", "--dry-run", "--always-make", "install"]
    done = subprocess.run(command, cwd=repository, capture_output=True, text=True, check=True)
    assert any(line.endswith(f"-m {_MODULE}") for line in done.stdout.splitlines())


def test_the_image_has_the_libraries(repository: Path) -> None:
    words = (repository / "Dockerfile").read_text().split()
    assert set(PACKAGES.values()) <= set(words)
