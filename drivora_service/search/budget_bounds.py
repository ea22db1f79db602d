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
from drivora_service.parameters import describe_parameters, parameter_problems, read_parameters
from drivora_service.search.plugin import TesterPlugin

MOST_CANDIDATES = 10_000
"""Most candidates of a population, whatever the budget: distances between all pairs of them still
fit the memory of an engine."""

MANY = 1_000_000
"""Most generations, cycles or steps, which are counted one by one and take no memory: no campaign
has more simulations."""

_KEY = "x-within-budget"


def within_budget(least: int, most: int = MOST_CANDIDATES) -> Any:
    """Returns the field of a parameter that numbers candidates to be simulated.

    A campaign may not set it to more than its number of simulations; the default is always allowed.
    ``population: Annotated[int, within_budget(2)] = 20`` is an example.

    Args:
        least: Least value.
        most: Greatest value, whatever the budget.
    """
    return Field(ge=least, le=most, json_schema_extra={_KEY: True})


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
    of = f"tester {plugin.name!r}"
    found = parameter_problems(plugin.parameters, parameters, of=of)
    yield from found
    if budget is None:
        return
    beyond = tuple(_beyond_budget(plugin, parameters, budget, {p.pointer for p in found}))
    yield from beyond
    if not found and not beyond:
        yield from _own_problems(plugin, parameters, budget)


def _beyond_budget(
    plugin: TesterPlugin[Any], parameters: Mapping[str, Any], budget: int, known: set[str]
) -> Iterator[Problem]:
    for one in describe_parameters(plugin.parameters):
        value = parameters.get(one.name)
        if not one.schema.get(_KEY) or f"/{one.name}" in known or not isinstance(value, int):
            continue
        # A small campaign, for a trial, needs no other parameters than a large one.
        most = max(budget, one.default)
        if value > most:
            least = one.schema.get("minimum", 0)
            why = (
                f"the budget is {budget} simulations for a seed scenario, and each of these "
                "candidates is simulated"
                if most == budget
                else f"the default; the budget is {budget} simulations for a seed scenario"
            )
            yield Problem(
                pointer=f"/{one.name}",
                code="beyond_budget",
                message=f"tester {plugin.name!r}: {one.name} is {value}; allowed: an integer from "
                f"{least} to {most} ({why}). Use fewer, or a greater budget",
            )


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
