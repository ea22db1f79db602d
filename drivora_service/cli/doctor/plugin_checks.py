"""Checks of agents and of plug-ins of installed packages."""

from __future__ import annotations

import json
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from functools import partial
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING

from drivora_service.cli.doctor.findings import Check, Finding, ok, problem
from drivora_service.cli.doctor.software_checks import CHILD_S

if TYPE_CHECKING:
    from drivora_service.settings import Settings

_PREFIX = "drivora_service."


def plugin_checks(settings: Settings) -> tuple[Check, ...]:
    """Returns the checks of agents and plug-ins.

    Args:
        settings: The settings of the environment and the options.
    """
    return (
        Check("plug-ins", check_plugins),
        Check("agents", partial(check_agents, settings)),
        Check("laws", partial(check_laws, settings)),
    )


def check_plugins() -> Iterator[Finding]:
    """Loads each plug-in in a process of its own: one may end it, or print what it likes."""
    found = metadata.entry_points()
    groups = sorted(group for group in found.groups if group.startswith(_PREFIX))
    points = [point for group in groups for point in found.select(group=group)]
    loaded: Counter[str] = Counter()
    for point in points:
        kind = point.group.removeprefix(_PREFIX)
        package = "" if point.dist is None else f" of {point.dist.name} {point.dist.version}"
        fault = _fault_of(point)
        if fault:
            yield problem(
                "plug-ins",
                f"{kind}: {point.name}{package} cannot be loaded: {fault}",
                "Mend it, or uninstall its package; all others work",
            )
        else:
            loaded[f"{kind}{package}"] += 1
    if loaded or not points:
        text = ", ".join(f"{count} {name}" for name, count in sorted(loaded.items()))
        yield ok("plug-ins", text or "none installed")


def _fault_of(point: metadata.EntryPoint) -> str:
    """Returns why a plug-in cannot be loaded, with file and line; "" if it can."""
    try:
        done = subprocess.run(
            [sys.executable, "-m", "drivora_service.cli.doctor.plugin_probe", point.value],
            capture_output=True,
            text=True,
            timeout=CHILD_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"not within {CHILD_S:g} s"
    lines = done.stdout.splitlines()
    if done.returncode == 0 and lines:
        return str(json.loads(lines[-1]))
    return f"its process ended with {done.returncode}"


def check_agents(settings: Settings) -> Iterator[Finding]:
    """Lists the agents that can be used; one of an operator's manifest that cannot is a problem."""
    from drivora_service.agents.catalogue import AgentCatalogue
    from drivora_service.agents.manifest_files import operator_manifests

    folder = settings.agents_folder
    own = operator_manifests(folder)
    of_packages = metadata.entry_points(group=f"{_PREFIX}agents").names
    entries = AgentCatalogue(folder=folder).entries()
    usable = [entry.name for entry in entries if entry.installed]
    optional = []
    for entry in entries:
        if entry.installed:
            continue
        if entry.name in own:
            yield problem(
                "agents", f"{entry.name}: {entry.reason}", f"Mend its manifest in {folder}"
            )
        elif entry.name in of_packages:
            # Those that cannot be imported at all are plug-ins that were reported already.
            if "cannot be loaded" not in entry.reason:
                yield problem("agents", f"{entry.name}: {entry.reason}", "Mend its package")
        else:
            optional.append(entry.name)
    yield ok("agents", f"{len(usable)} can be used: {', '.join(usable)}")
    if optional:
        yield ok(
            "agents",
            f"not installed: {', '.join(optional)}; `drivora agents install NAME` installs one",
        )


def check_laws(settings: Settings) -> Iterator[Finding]:
    """Reads the user's traffic laws."""
    from drivora_service.cli.application.installation import oracle_catalogue

    folder = Path(settings.laws_folder)
    files = sorted(folder.glob("*.yaml")) if folder.is_dir() else []
    if not files:
        return
    try:
        names = oracle_catalogue(settings).names()
    except Exception as error:
        yield problem("laws", f"{folder}: {error}", "`drivora laws` says more")
        return
    yield ok("laws", f"{len(files)} files in {folder}; {len(names)} oracles in all")
