"""Configurations: an ADS and the parameters that differ from its defaults, in words and as an id.

Two runs of one ADS with other parameters are runs of two ADSs for most questions, so lists, tables
and filters go by the configuration rather than by the name alone.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from drivora_service.errors import UnknownName
from drivora_service.parameters import ParameterDescription
from drivora_service.scenario.model import AgentChoice
from drivora_service.short_values import short_value

ID_LENGTH = 8
"""Hexadecimal digits of an id: two of a thousand configurations share one in 1 of 8000 stores."""
LONGEST_WORDS = 400
"""Characters of the words; longer ones are cut, and the id tells configurations apart."""
_LONGEST_VALUE = 40
"""Characters of one value in the words."""

DeclaredParameters = Callable[[str], tuple[ParameterDescription, ...] | None]
"""Returns the parameters of an agent, ``None`` if it declares none; raises ``UnknownName``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentConfiguration:
    """What drives the egos of a run.

    Attributes:
        words: Name of the ADS with the parameters that differ from its defaults, in the order in
            which it declares them: ``idm · reaction_time 1.0``. Several are joined by commas.
        id: Hash of the names and of the values of all parameters, 8 hexadecimal digits: the same
            whether a default is written or left out. "": not known.
    """

    words: str
    id: str = ""


def configuration_of(
    choices: Iterable[AgentChoice], declared: DeclaredParameters
) -> AgentConfiguration:
    """Returns the configuration of the agents of all egos; equal agents count once.

    An agent that is not installed here, or declares no parameters, is described by the parameters
    that it was given.

    Args:
        choices: The agents in the order of the egos.
        declared: Looks up the parameters of an agent.
    """
    found: dict[str, str] = {}
    for choice in choices:
        described = _descriptions(choice.name, declared)
        found.setdefault(_identity(choice, described), _words(choice, described))
    return AgentConfiguration(words=_cut(",".join(found.values())), id=_id(tuple(found)))


def _descriptions(
    name: str, declared: DeclaredParameters
) -> tuple[ParameterDescription, ...] | None:
    try:
        return declared(name)
    except UnknownName:
        return None


def _identity(choice: AgentChoice, described: Sequence[ParameterDescription] | None) -> str:
    """Returns the name and all parameters as canonical JSON."""
    defaults = {one.name: one.default for one in described or ()}
    return _canonical([choice.name, {**defaults, **choice.parameters}])


def _id(identities: tuple[str, ...]) -> str:
    return hashlib.sha256("\n".join(identities).encode()).hexdigest()[:ID_LENGTH]


def _words(choice: AgentChoice, described: Sequence[ParameterDescription] | None) -> str:
    given = dict(choice.parameters)
    shown = []
    for one in described or ():
        if one.name in given:
            value = given.pop(one.name)
            if _canonical(value) != _canonical(one.default):
                shown.append((one.name, _as_declared(value, one.schema)))
    # Of an agent that declares no parameters, no default is known.
    shown += sorted(given.items())
    return " · ".join((choice.name, *(f"{name} {_value_text(value)}" for name, value in shown)))


def _as_declared(value: Any, schema: Mapping[str, Any]) -> Any:
    """Returns an integer as a decimal number where the parameter takes these: 1 and 1.0 are one."""
    if not isinstance(value, int) or isinstance(value, bool):
        return value
    types = {one.get("type") for one in (schema, *schema.get("anyOf", ()))}
    return float(value) if "number" in types and "integer" not in types else value


def _value_text(value: Any) -> str:
    text = value if isinstance(value, str) else short_value(value, longest=_LONGEST_VALUE)
    text = " ".join(text.split())
    return text if len(text) <= _LONGEST_VALUE else f"{text[: _LONGEST_VALUE - 1]}…"


def _cut(words: str) -> str:
    return words if len(words) <= LONGEST_WORDS else f"{words[: LONGEST_WORDS - 1]}…"


def _canonical(value: Any) -> str:
    """Returns JSON text that is the same for equal values: 1 and 1.0 are equal."""
    return json.dumps(_plain(value), sort_keys=True, ensure_ascii=False, separators=(",", ":"))


def _plain(value: Any) -> Any:
    if isinstance(value, float) and value.is_integer():
        return int(value)
    if isinstance(value, Mapping):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(one) for one in value]
    return value
