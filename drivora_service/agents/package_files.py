"""Files of other packages for agents: fetched by name and version, checked by hash."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from drivora_service.errors import AgentError

_PATIENCE_S = 1800.0
_ADVICE = "Check the connection to the package registry (pip's settings count) and try again"


@dataclass(frozen=True, slots=True, kw_only=True)
class PackageFile:
    """Files in one file of the package registry.

    Attributes:
        package: Name of the package.
        version: The exact version.
        file: Name of the wheel or source archive, which identifies the file of a version.
        sha256: Hash of that file, hexadecimal.
        members: Names of its members in the agent's folder, by their paths in the file.
    """

    package: str
    version: str
    file: str
    sha256: str
    members: Mapping[str, str]

    @property
    def identity(self) -> str:
        """Text that changes with the fetched content."""
        members = " ".join(f"{path}={name}" for path, name in sorted(self.members.items()))
        return f"{self.file} {self.sha256} {members}"


def fetch(wanted: PackageFile, folder: Path) -> None:
    """Downloads a file of the registry with pip and copies its members into ``folder``.

    Raises:
        AgentError: It is unavailable, is another file than expected, or lacks a member.
    """
    with (
        tempfile.TemporaryDirectory(prefix="drivora-fetch-") as download,
        tempfile.TemporaryDirectory(prefix="drivora-unpack-") as scratch,
    ):
        path = Path(download) / wanted.file
        log = _download(wanted, Path(download), Path(scratch))
        unpacked = _find_unpacked_source(Path(scratch))
        if not path.is_file() and unpacked is not None:
            _copy_unpacked(wanted, unpacked, folder)
            return
        if log:
            raise _make_error(
                wanted, f"pip failed. {_ADVICE}. Its last output:\n{log.strip()}", log
            )
        if not path.is_file():
            found = ", ".join(sorted(p.name for p in Path(download).iterdir())) or "nothing"
            raise _make_error(
                wanted,
                f"found {found}, wanted {wanted.file}: for this system, or this version of Python, "
                "the registry offers another file than the one that the agent was made with",
            )
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        if digest != wanted.sha256:
            raise _make_error(
                wanted, f"the file has the hash sha256:{digest}, wanted sha256:{wanted.sha256}"
            )
        for member, name in wanted.members.items():
            content = _read_member(path, member)
            if content is None:
                raise _make_error(wanted, f"there is no {member} in {wanted.file}")
            (folder / name).write_bytes(content)


def fetch_all(files: Iterable[PackageFile], folder: Path) -> None:
    """Fetches several; see :func:`fetch`."""
    for wanted in files:
        fetch(wanted, folder)


def _download(wanted: PackageFile, folder: Path, scratch: Path) -> str:
    """Runs pip, which unpacks in ``scratch``; returns its last output if it failed, else ""."""
    command = [
        sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check",
        "--no-input", "--no-deps", "--dest", str(folder),
    ]  # fmt: skip
    requirement = f"{wanted.package}=={wanted.version}"
    if wanted.file.endswith(".whl"):
        # The package's supported versions of Python are irrelevant: it is not installed,
        # and its file is identified by name and hash.
        command += ["--only-binary", ":all:", "--ignore-requires-python", requirement]
    else:
        listed = scratch / "requirements.txt"
        listed.write_text(f"{requirement} --hash=sha256:{wanted.sha256}\n", encoding="utf-8")
        command += ["--no-binary", ":all:", "--no-build-isolation", "--no-clean"]
        command += ["--require-hashes", "--requirement", str(listed)]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=_PATIENCE_S, check=False,
            env={**os.environ, "TMPDIR": str(scratch)},
        )  # fmt: skip
    except subprocess.TimeoutExpired as error:
        raise _make_error(wanted, f"pip did not end within {_PATIENCE_S:g} s. {_ADVICE}") from error
    return done.stderr[-4000:] or "no output" if done.returncode else ""


def _find_unpacked_source(scratch: Path) -> Path | None:
    """Returns the folder into which pip unpacked a source archive, if it did.

    pip compares an archive's hash, unpacks it, and then asks the package's build for its
    dependencies, which fails without the build's requirements. The files are complete anyway.
    """
    found = sorted(path.parent for path in scratch.glob("*/*/PKG-INFO"))
    return found[0] if found else None


def _copy_unpacked(wanted: PackageFile, source: Path, folder: Path) -> None:
    for member, name in wanted.members.items():
        path = source / member.partition("/")[2]
        if not path.is_file():
            raise _make_error(wanted, f"there is no {member} in {wanted.file}")
        (folder / name).write_bytes(path.read_bytes())


def _read_member(path: Path, member: str) -> bytes | None:
    if path.suffix in (".whl", ".zip"):
        with zipfile.ZipFile(path) as wheel:
            return wheel.read(member) if member in wheel.namelist() else None
    with tarfile.open(path) as archive:
        try:
            file = archive.extractfile(member)
        except KeyError:
            return None
        return None if file is None else file.read()


def _make_error(wanted: PackageFile, why: str, log: str = "") -> AgentError:
    return AgentError(
        f"{wanted.package} {wanted.version} cannot be fetched: {why}",
        cause="agent_install",
        log=log,
    )
