"""Folders of agents for tests: manifests of ADSs in processes of their own."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import psutil
import yaml

from drivora_service.agents.manifest_files import FILE_NAME

ADS = Path(__file__).with_name("ads.py")


def add_agent(
    folder: Path, what: str, *, step: float = 20.0, start: float = 60.0, **more: object
) -> None:
    """Writes the manifest of an ADS that does ``what``, and is called so."""
    home = folder / what
    home.mkdir(parents=True)
    shutil.copy(ADS, home / "ads.py")
    manifest = {
        "name": what,
        "kind": "baseline",
        "description": f"does: {what}",
        "source": "tests",
        "licence": "Apache-2.0",
        "command": ["{python}", "{folder}/ads.py", what],
        "deadlines": {"start": start, "setup": step, "step": step},
        **more,
    }
    (home / FILE_NAME).write_text(yaml.safe_dump(manifest))


def processes_with(words: Sequence[str]) -> list[psutil.Process]:
    """Returns the processes whose command line holds all of ``words``.

    What was found is in their ``info``, with their names: one may have ended since.
    """
    found = []
    for process in psutil.process_iter(["cmdline", "name"]):
        line = " ".join(process.info["cmdline"] or ())
        if all(word in line for word in words):
            found.append(process)
    return found


def wait_until(is_so: Callable[[], bool]) -> None:
    """Waits for what happens in other processes, a minute at most."""
    limit = time.monotonic() + 60
    while not is_so():
        assert time.monotonic() < limit
        time.sleep(0.05)
