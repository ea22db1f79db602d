"""The changes of a running episode: actors that join it, and the weather.

Those of the scenario are known from the beginning, others are added during the run. Both are made
at the beginning of the same step and in the same order, so that an episode of the scenario with
what was added is the same run.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from drivora_service.scenario.model import (
    NpcVehicle,
    NpcWalker,
    Scenario,
    Weather,
    WeatherChange,
)
from drivora_service.scenario.weather import WeatherEffects, weather_effects

NEVER = 2**62
"""A step that no episode reaches."""
_EPSILON = 1e-9

Joining = NpcVehicle | NpcWalker
"""An actor that joins a running episode."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Due:
    """The changes at the beginning of a step.

    Attributes:
        weather: The weather from now on; ``None``: as before.
        joining: The actors that join, in the order of their rows.
    """

    weather: Weather | None
    joining: tuple[Joining, ...]


def changes_anything(scenario: Scenario) -> bool:
    """Returns whether actors join or the weather changes while a scenario runs."""
    return bool(scenario.weather_changes or joining_actors(scenario))


def joining_actors(scenario: Scenario) -> tuple[tuple[int, Joining], ...]:
    """Returns the steps in which actors join, with the actors, in the order of their rows.

    Of those of one step vehicles come first, each kind in the order of its list.
    """
    step_length = scenario.step_length
    actors: Sequence[Joining] = (*scenario.npc_vehicles, *scenario.npc_walkers)
    joining = [(join_step(a.start_time, step_length), a) for a in actors if a.joins]
    return tuple(sorted(joining, key=lambda pair: pair[0]))


def join_step(start_time: float, step_length: float) -> int:
    """Returns the step in which an actor joins: the one after which it is there."""
    return max(math.ceil((start_time - _EPSILON) / step_length) - 1, 0)


def change_step(time: float, step_length: float) -> int:
    """Returns the step that is the first in another weather."""
    return max(math.ceil((time - _EPSILON) / step_length), 0)


def weather_by_step(scenario: Scenario) -> Callable[[int], WeatherEffects]:
    """Returns the function of a step that returns the effects of the weather in it."""
    changes = scenario.weather_changes
    steps = [change_step(change.time, scenario.step_length) for change in changes]
    weathers = (scenario.weather, *(change.weather for change in changes))
    effects = [weather_effects(weather) for weather in weathers]
    return lambda step: effects[bisect_right(steps, step)]


class Changes:
    """The changes that an episode has still to make, and the scenario that has them all.

    Attributes:
        scenario: The scenario with what was added to it.
        next_step: The step in which the next change is due; ``NEVER`` if there is none.
    """

    def __init__(self, scenario: Scenario) -> None:
        """Args: scenario: The scenario whose changes are all still to be made."""
        self.scenario = scenario
        self._done = -1
        self._settle()

    @property
    def ids(self) -> frozenset[str]:
        """Ids of all actors that join, or have joined."""
        return frozenset(actor.id for _, actor in joining_actors(self.scenario))

    def add(self, actor: Joining, step: int) -> Joining:
        """Adds an actor, which joins at its start time, at the earliest in ``step``.

        Returns:
            The actor as the scenario has it.
        """
        scenario = self.scenario
        earliest = (step + 1) * scenario.step_length
        start_time = max(actor.start_time, earliest)
        if isinstance(actor, NpcVehicle):
            vehicle = replace(actor, joins=True, start_time=start_time)
            vehicles = (*scenario.npc_vehicles, vehicle)
            self.scenario = replace(scenario, npc_vehicles=vehicles)
            self._settle()
            return vehicle
        walker = replace(actor, joins=True, start_time=start_time)
        self.scenario = replace(scenario, npc_walkers=(*scenario.npc_walkers, walker))
        self._settle()
        return walker

    def set_weather(self, weather: Weather, step: int) -> None:
        """Changes the weather from ``step`` on; one that was set for the same time is replaced."""
        scenario = self.scenario
        change = WeatherChange(time=step * scenario.step_length, weather=weather)
        known = scenario.weather_changes
        place = bisect_right([one.time for one in known], change.time + _EPSILON)
        before = [one for one in known[:place] if one.time < change.time - _EPSILON]
        self.scenario = replace(scenario, weather_changes=(*before, change, *known[place:]))
        self._settle()

    def take(self, step: int) -> Due:
        """Returns the changes that are due in a step, which counts as begun."""
        due = Due(
            weather=next((one.weather for k, one in reversed(self._weather) if k <= step), None),
            joining=tuple(actor for k, actor in self._joining if k <= step),
        )
        self._done = step
        self._settle()
        return due

    def _settle(self) -> None:
        """Notes what is still to come."""
        step_length = self.scenario.step_length
        self._joining = [(k, a) for k, a in joining_actors(self.scenario) if k > self._done]
        self._weather = [
            (k, change)
            for change in self.scenario.weather_changes
            if (k := change_step(change.time, step_length)) > self._done
        ]
        steps = [k for k, _ in (*self._joining, *self._weather)]
        self.next_step = min(steps, default=NEVER)
