"""Installation of agents' requirements: their own environments, and files of other packages.

All of it is in a folder of agents, and counts only with a stamp, which is written last and names
the
content: an incomplete installation is never used.
"""

from __future__ import annotations

import contextlib
import hashlib
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from drivora_service.agents.manifest import AgentManifest
from drivora_service.agents.package_files import PackageFile, fetch_all
from drivora_service.errors import AgentError

REQUIREMENTS = "requirements.txt"
"""File beside a manifest with the packages of its environment, pinned and with hashes."""

_STAMP = "installed"
_LOG_CHARACTERS = 4000


def environment_python(manifest: AgentManifest, agents: Path | None) -> Path | None:
    """Returns the interpreter for an ADS: of its environment, or Drivora's if it needs none.

    Returns:
        ``None`` if its environment is not installed.
    """
    requirements = manifest.folder / REQUIREMENTS
    if not requirements.is_file():
        return Path(sys.executable)
    if agents is None:
        return None
    environment = _environment(manifest, agents)
    return _python(environment) if _is_whole(environment, _identity(requirements)) else None


def install_environment(manifest: AgentManifest, agents: Path, *, again: bool = False) -> bool:
    """Creates the virtual environment of an ADS.

    Args:
        manifest: Manifest of the ADS; its requirements are beside it.
        agents: The folder of agents.
        again: Recreate an existing one.

    Returns:
        Whether it was created.

    Raises:
        AgentError: It cannot be created, or another process is creating it.
    """
    requirements = manifest.folder / REQUIREMENTS
    if not requirements.is_file():
        return False
    environment = _environment(manifest, agents)
    identity = _identity(requirements)
    with _lock_folder(environment.parent):
        if _is_whole(environment, identity) and not again:
            return False
        _remove(environment)
        _run([sys.executable, "-m", "venv", "--without-pip", str(environment)])
        _run(
            [
                sys.executable, "-m", "pip", "--python", str(_python(environment)), "install",
                "--quiet", "--no-input", "--disable-pip-version-check", "--require-hashes",
                *(["--no-deps", "--ignore-requires-python"] if manifest.resolved else []),
                "-r", str(requirements),
            ]
        )  # fmt: skip
        (environment / _STAMP).write_text(identity)
    return True


def installed_files(name: str, files: Sequence[PackageFile], agents: Path | None) -> Path | None:
    """Returns the folder with the fetched files of an agent, ``None`` if they are missing."""
    if agents is None:
        return None
    folder = agents / name / "files"
    return folder if _has(folder, _files_identity(files)) else None


def install_files(
    name: str, files: Sequence[PackageFile], agents: Path, *, again: bool = False
) -> bool:
    """Fetches the files of an agent; arguments and errors as for :func:`install_environment`."""
    folder, identity = agents / name / "files", _files_identity(files)
    with _lock_folder(folder.parent):
        if _has(folder, identity) and not again:
            return False
        fresh = folder.with_name("files.new")
        _remove(fresh)
        fresh.mkdir(parents=True)
        fetch_all(files, fresh)
        (fresh / _STAMP).write_text(identity)
        _remove(folder)
        fresh.rename(folder)
    return True


def _environment(manifest: AgentManifest, agents: Path) -> Path:
    return agents.resolve() / manifest.environment / "venv"


def _python(environment: Path) -> Path:
    return environment / "bin" / "python"


def _is_whole(environment: Path, identity: str) -> bool:
    # Its interpreter is a link to the one that created it, which may have been moved or removed.
    return _has(environment, identity) and _python(environment).exists()


def _identity(requirements: Path) -> str:
    digest = hashlib.sha256(requirements.read_bytes()).hexdigest()
    return f"{digest} python {sys.version_info.major}.{sys.version_info.minor}"


def _files_identity(files: Sequence[PackageFile]) -> str:
    return hashlib.sha256("\n".join(file.identity for file in files).encode()).hexdigest()


def _has(folder: Path, identity: str) -> bool:
    try:
        return (folder / _STAMP).read_text() == identity
    except OSError:
        return False


def _remove(folder: Path) -> None:
    # The stamp first, so that the rest does not count after an interruption.
    (folder / _STAMP).unlink(missing_ok=True)
    if folder.exists():
        shutil.rmtree(folder)


@contextlib.contextmanager
def _lock_folder(folder: Path) -> Iterator[None]:
    """Prevents other processes from installing into a folder at the same time."""
    # Imported here, so that workers, which import this module, do not get its fork hooks.
    from filelock import Timeout, UnixFileLock

    # The mere existence of a file, unlike a lock on it, would outlive a killed process.
    lock = UnixFileLock(folder / "lock", fallback_to_soft=False)
    try:
        held = lock.acquire(blocking=False)
    except Timeout:
        raise _make_error(
            f"another process is installing into {folder}: wait for its end"
        ) from None
    except OSError as error:
        raise _make_error(f"{folder} cannot be written: {error.strerror}") from error
    with held:
        yield


def _run(command: list[str]) -> None:
    done = subprocess.run(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode:
        raise _make_error(
            f"an environment cannot be made: `{' '.join(command)}` exited with code "
            f"{done.returncode}. Its last output:\n{done.stdout[-_LOG_CHARACTERS:]}"
        )


def _make_error(message: str) -> AgentError:
    return AgentError(message, cause="agent_install")
