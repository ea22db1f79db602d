"""The system libraries that libsumo links and its wheel does not contain.

``make install`` runs this module, and so do users of the wheel (``python -m``): it checks that
libsumo can be loaded, installs missing libraries if it is allowed to, and else prints the command
to run. Workers use :func:`explain` in reports.
"""

from __future__ import annotations

import ctypes
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

PACKAGES: Mapping[str, str] = {
    "libX11.so.6": "libx11-6",
    "libXext.so.6": "libxext6",
    "libXrender.so.1": "libxrender1",
    "libGL.so.1": "libgl1",
    "libatomic.so.1": "libatomic1",
}
"""The libraries, each with its package in Debian and Ubuntu."""

MANAGERS = ("apt-get", "dnf")
"""Package managers that :func:`install_commands` supports; the first one found is used."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Remedy:
    """How to install missing libraries.

    Attributes:
        commands: Commands to run one after another; empty if no package manager is known.
        allowed: Whether this process may run them.
        line: The same as one line for a shell, or a sentence if there are no commands.
    """

    commands: tuple[tuple[str, ...], ...]
    allowed: bool
    line: str


def find_missing_libraries() -> tuple[str, ...]:
    """Returns the libraries of :data:`PACKAGES` that the system's loader cannot load."""
    return tuple(name for name in PACKAGES if not _loads(name))


def install_commands(manager: str, libraries: Sequence[str]) -> tuple[tuple[str, ...], ...]:
    """Returns the commands with which a package manager installs libraries.

    Args:
        manager: One of :data:`MANAGERS`.
        libraries: Keys of :data:`PACKAGES`.
    """
    if manager == "apt-get":
        packages = (PACKAGES[name] for name in libraries)
        return (
            ("apt-get", "update"),
            ("apt-get", "install", "--yes", "--no-install-recommends", *packages),
        )
    # An RPM provides each library in it under the library's own name, so that no package needs to
    # be named; dnf(8), "Specifying Packages".
    suffix = "()(64bit)" if sys.maxsize > 2**32 else ""
    return (("dnf", "install", "--assumeyes", *(name + suffix for name in libraries)),)


def remedy(libraries: Sequence[str], *, path: str | None, is_root: bool) -> Remedy:
    """Returns how to install missing libraries.

    Args:
        libraries: Keys of :data:`PACKAGES`, at least one.
        path: Search path of package managers, as in ``PATH``; ``None``: ``PATH`` itself.
        is_root: Whether the process may install packages.
    """
    for manager in MANAGERS:
        if shutil.which(manager, path=path) is not None:
            commands = install_commands(manager, libraries)
            line = " && ".join(map(shlex.join, commands))
            if not is_root:
                line = f"sudo {line}" if len(commands) == 1 else f"sudo sh -c {shlex.quote(line)}"
            return Remedy(commands=commands, allowed=is_root, line=line)
    return Remedy(
        commands=(),
        allowed=False,
        line=f"install {', '.join(libraries)} with the package manager of this system",
    )


def explain(error: ImportError) -> str:
    """Returns why libsumo cannot be loaded, and what to do.

    Args:
        error: The exception of the import.
    """
    found = f"libsumo cannot be loaded: {error}"
    missing = find_missing_libraries()
    if not missing:
        return f"{found}. None of the libraries that it needs of the system is missing; {_AGAIN}"
    line = remedy(missing, path=None, is_root=os.geteuid() == 0).line
    return f"{found}. Missing on this system: {', '.join(missing)}. Run: {line}"


def main() -> int:
    """Ensures that libsumo can be loaded; returns the exit code."""
    error = _find_import_error()
    if not error:
        return 0
    missing = find_missing_libraries()
    if not missing:
        print(f"libsumo cannot be loaded: {error}\n{_AGAIN}", file=sys.stderr)
        return 1
    todo = remedy(missing, path=None, is_root=os.geteuid() == 0)
    print(f"libsumo needs libraries that are missing here: {', '.join(missing)}", file=sys.stderr)
    if not todo.allowed:
        print(
            f"Install them, then run this or `make install` again:\n  {todo.line}", file=sys.stderr
        )
        return 1
    print(f"Installing them: {todo.line}", file=sys.stderr, flush=True)
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    for command in todo.commands:
        done = subprocess.run(command, env=environment, stdout=sys.stderr, check=False)
        if done.returncode:
            print(
                f"`{shlex.join(command)}` ended with {done.returncode}. Install the libraries, "
                f"then run this or `make install` again:\n  {todo.line}",
                file=sys.stderr,
            )
            return 1
    error = _find_import_error()
    if error:
        print(f"libsumo still cannot be loaded: {error}", file=sys.stderr)
    return 1 if error else 0


_AGAIN = (
    "install libsumo again: `pip install --force-reinstall --no-deps libsumo`; in a checkout "
    "remove .venv, then run `make install`"
)


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def _find_import_error() -> str:
    """Returns why a new process cannot import libsumo, "" if it can."""
    done = subprocess.run(
        [sys.executable, "-c", "import libsumo"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )
    if done.returncode == 0:
        return ""
    return (done.stderr.strip() or f"the process ended with {done.returncode}").splitlines()[-1]


if __name__ == "__main__":
    sys.exit(main())
