"""What two batches are, and in what they differ."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from drivora_service.suites.paired.batch_comparison import SettingDifference
from drivora_service.suites.paired.paired_runs import PairedRun

AGENT = "agent"
_VERSION = "version of "
_LONGEST_TITLE = 80

_Values = Mapping[str, tuple[str, ...]]
"""The different values in runs by name."""


def setting_differences(
    first: Sequence[PairedRun], second: Sequence[PairedRun]
) -> tuple[SettingDifference, ...]:
    """Returns the agents, parameters and versions in which the runs of two batches differ.

    Parameters are compared of agents that both have, and versions of software that took part in
    both.
    """
    agents_a, agents_b = _parameters(first), _parameters(second)
    found: list[SettingDifference] = []
    if agents_a.keys() != agents_b.keys():
        found.append(SettingDifference(name=AGENT, a=", ".join(agents_a), b=", ".join(agents_b)))
    for agent, mine in agents_a.items():
        theirs = agents_b.get(agent, {})
        # Runs that were not simulated know no parameters.
        if mine and theirs:
            found += _find_differences(
                f"{agent}.", mine, theirs, tuple(dict.fromkeys((*mine, *theirs)))
            )
    mine, theirs = _versions(first), _versions(second)
    found += _find_differences(_VERSION, mine, theirs, [name for name in mine if name in theirs])
    return tuple(found)


def _find_differences(
    prefix: str, a: _Values, b: _Values, names: Sequence[str]
) -> Iterator[SettingDifference]:
    for name in names:
        mine, theirs = a.get(name, ()), b.get(name, ())
        if mine != theirs:
            yield SettingDifference(name=f"{prefix}{name}", a=", ".join(mine), b=", ".join(theirs))


def agents_in_words(
    runs: Sequence[PairedRun],
    others: Sequence[PairedRun],
    differences: Sequence[SettingDifference],
    *,
    is_b: bool,
) -> tuple[str, ...]:
    """Returns the agents of a batch, each with the parameters that set it apart.

    These are the parameters that differ from the agent's defaults. If both batches have the same
    ones, as after a change of a default, it is the parameters in which the batches differ.

    Args:
        runs: Runs of the batch.
        others: Runs of the other batch.
        differences: In what the batches differ.
        is_b: Whether it is the second batch.
    """
    mine, theirs = _configurations(runs), _configurations(others)
    if mine and theirs and mine != theirs:
        return mine
    texts = []
    for agent in _parameters(runs):
        told = [
            f"{one.name.removeprefix(f'{agent}.')} {one.b if is_b else one.a}"
            for one in differences
            if one.name.startswith(f"{agent}.")
        ]
        texts.append(f"{agent} with {', '.join(told)}" if told else agent)
    return tuple(texts)


def title(
    agents: Sequence[str],
    differences: Sequence[SettingDifference],
    *,
    name: str,
    other_name: str,
    is_b: bool,
) -> str:
    """Returns what sets a batch apart from the other one.

    Args:
        agents: Its agents in words.
        differences: In what the batches differ.
        name: Display name of the batch.
        other_name: Display name of the other batch.
        is_b: Whether it is the second batch.

    Returns:
        Its agents if they or their parameters differ; else the versions that differ, or its name;
        "" if they do not differ either.
    """
    versions = [one for one in differences if one.name.startswith(_VERSION)]
    text = ""
    if len(versions) < len(differences):
        text = ", ".join(agents)
    elif versions:
        text = ", ".join(
            f"{one.name.removeprefix(_VERSION)} {one.b if is_b else one.a}" for one in versions
        )
    if text and len(text) <= _LONGEST_TITLE:
        return text
    return name if name != other_name else ""


def _configurations(runs: Sequence[PairedRun]) -> tuple[str, ...]:
    """Returns the configurations of runs in words; none if that of a run is not known."""
    if not all(run.configuration_id for run in runs):
        return ()
    return tuple(sorted({run.configuration for run in runs}))


def _parameters(runs: Sequence[PairedRun]) -> Mapping[str, _Values]:
    found: dict[str, dict[str, dict[str, None]]] = {}
    for run in runs:
        for choice in run.agents.values():
            known = found.setdefault(choice.name, {})
            for name, value in choice.parameters.items():
                known.setdefault(name, {})[_text(value)] = None
        if not run.agents:
            for agent in run.agent.split(","):
                found.setdefault(agent, {})
    return {
        agent: {name: tuple(sorted(values)) for name, values in found[agent].items()}
        for agent in sorted(found)
    }


def _versions(runs: Sequence[PairedRun]) -> _Values:
    found: dict[str, set[str]] = defaultdict(set)
    for run in runs:
        for name, version in run.versions.items():
            found[name].add(_text(version))
    return {name: tuple(sorted(found[name])) for name in sorted(found)}


def _text(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value, sort_keys=True, default=str)
