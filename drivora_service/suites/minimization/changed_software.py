"""The software of a run compared with that of today: what is missing, and what has changed."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from typing import Any, Protocol

from drivora_service.plugin_table import describe_missing_packages
from drivora_service.scenario.model import AgentChoice


class Performed(Protocol):
    """A run, or the report of one."""

    @property
    def versions(self) -> Mapping[str, Any]:
        """Versions of the software that took part, by name."""
        ...

    @property
    def agents(self) -> Mapping[str, AgentChoice]:
        """Agent of each ego, with the values of all its parameters."""
        ...


def find_missing(
    run: Performed, oracle: str, *, oracles: Collection[str], agents: Mapping[str, str]
) -> tuple[str, ...]:
    """Returns what a run needs to fail again and is not installed, in words.

    Args:
        run: The run.
        oracle: Oracle whose violation is followed.
        oracles: Names of all oracles that judge runs here.
        agents: Why an agent cannot be used here, by its name; "": it can.
    """
    lacking = [] if oracle in oracles else [f"oracle {oracle!r} is not installed"]
    for name in dict.fromkeys(choice.name for choice in run.agents.values()):
        if name not in agents:
            lacking.append(f"agent {name!r} is not installed")
        elif reason := agents[name]:
            lacking.append(f"agent {name!r} cannot be used: {reason}")
    if lacking and (packages := describe_missing_packages(run.versions, "it")):
        lacking.append(packages)
    return tuple(lacking)


def changed_software(before: Performed, after: Performed) -> tuple[str, ...]:
    """Returns what took part in a run in another version than in a later one, in words.

    Args:
        before: The run.
        after: The later run, or its report.
    """
    old, new = _versions(before), _versions(after)
    return tuple(
        f"version of {name}: {old.get(name, 'none')}, now {new.get(name, 'none')}"
        for name in dict.fromkeys((*old, *new))
        if old.get(name) != new.get(name)
    )


def _versions(run: Performed) -> dict[str, str]:
    if not run.versions:
        # It ended before anything was loaded, or lost its worker.
        return {}
    named = {name: str(value) for name, value in run.versions.items()}
    for ego, agent in run.agents.items():
        parameters = json.dumps(dict(agent.parameters), sort_keys=True)
        named[f"agent of {ego}"] = f"{agent.name} {parameters}"
    return named
