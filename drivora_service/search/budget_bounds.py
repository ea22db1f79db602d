"""Bounds of a tester's parameters that follow from the budget of its campaign.

A population of more candidates than there are simulations cannot be simulated, and takes memory and
time all the same. So a field that numbers candidates to be simulated is declared with
:func:`within_budget`, and what depends on several fields is checked by ``TesterPlugin.check``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import Field

from drivora_service.errors import DrivoraError, Problem
from drivora_service.foreign_errors import exception_place
from drivora_service.parameters import (
    WITHIN_BUDGET,
    describe_parameters,
    parameter_problems,
    read_parameters,
)
from drivora_service.search.plugin import TesterPlugin

MOST_CANDIDATES = 10_000
"""Most candidates of a population, whatever the budget: distances between all pairs of them still
fit the memory of an engine."""

MANY = 1_000_000
"""Most generations, cycles or steps, which are counted one by one and take no memory: no campaign
has more simulations."""


def within_budget(least: int, most: int = MOST_CANDIDATES) -> Any:
    """Returns the field of a parameter that numbers candidates to be simulated.

    A campaign may not set it to more than its number of simulations; the default is always allowed.
    ``population: Annotated[int, within_budget(2)] = 20`` is an example.

    Args:
        least: Least value.
        most: Greatest value, whatever the budget.
    """
    return Field(ge=least, le=most, json_schema_extra={WITHIN_BUDGET: True})


def problems_of_tester(
    plugin: TesterPlugin[Any], parameters: Mapping[str, Any], budget: int | None
) -> Iterator[Problem]:
    """Yields what is wrong with the parameters that a campaign gives its tester.

    Args:
        plugin: The tester.
        parameters: Values by name, as in JSON.
        budget: Simulations of each seed scenario; ``None``: not known, or not to be checked, as of
            a campaign that an earlier version has stored.

    Yields:
        Problems with pointers that begin at the parameters: ``/population``.
    """
    beyond = {} if budget is None else dict(_beyond_budget(plugin, parameters, budget))
    found = parameter_problems(plugin.parameters, parameters, of=f"tester {plugin.name!r}")
    # Where both bounds are exceeded, the one of the budget is the one that has to be met.
    yield from (one for one in found if one.pointer not in beyond)
    yield from beyond.values()
    if budget is not None and not found and not beyond:
        yield from _own_problems(plugin, parameters, budget)


def _beyond_budget(
    plugin: TesterPlugin[Any], parameters: Mapping[str, Any], budget: int
) -> Iterator[tuple[str, Problem]]:
    for one in describe_parameters(plugin.parameters):
        value, schema = parameters.get(one.name), _bounded(one.schema)
        if schema is None or not isinstance(value, int) or isinstance(value, bool):
            continue
        # A small campaign, for a trial, needs no other parameters than a large one.
        has_default = isinstance(one.default, int)
        least = one.default if has_default else schema["minimum"]
        most = min(max(budget, least), schema["maximum"])
        if value <= most:
            continue
        if most == budget:
            why = "the budget of a seed scenario, as each of these candidates is simulated"
        elif most == least:
            what = "the default" if has_default else "the least value"
            why = f"{what}; the budget of a seed scenario is {budget}"
        else:
            why = "whatever the budget"
        message = (
            f"tester {plugin.name!r}: {one.name} is {value}; allowed: an integer from "
            f"{schema['minimum']} to {most} ({why})"
        )
        pointer = f"/{one.name}"
        yield pointer, Problem(pointer=pointer, code="beyond_budget", message=message)


def _bounded(schema: Mapping[str, Any]) -> Mapping[str, Any] | None:
    """Returns the schema of the numbers that the budget bounds; ``None``: it bounds none."""
    # A parameter that may also be null has one schema for each.
    choices = (schema, *schema.get("anyOf", ()))
    return next((choice for choice in choices if choice.get(WITHIN_BUDGET)), None)


def _own_problems(
    plugin: TesterPlugin[Any], parameters: Mapping[str, Any], budget: int
) -> Iterator[Problem]:
    """Yields what the plug-in itself finds; it is code of others, which may raise."""
    try:
        read = read_parameters(plugin.parameters, parameters, of=f"tester {plugin.name!r}")
        yield from tuple(plugin.check(read, budget))
    except DrivoraError as error:
        yield Problem(pointer="", code="plugin", message=str(error))
    except Exception as error:
        message = (
            f"tester {plugin.name!r} raised {type(error).__name__} when it checked its "
            f"parameters: {error}{exception_place(error)}"
        )
        yield Problem(pointer="", code="plugin", message=message)
