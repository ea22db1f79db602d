"""An agent that writes to everything that it is handed changes nothing of the evidence."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, MutableMapping, MutableSequence
from typing import Any

import numpy as np
import pytest

from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.agents.interface import AccelerationControl, AgentContext, Control, Observation
from drivora_service.agents.log import AgentLog
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.scenario.model import BackgroundTraffic, Scenario, Weather
from tests.simulation.episodes import car, ego, place, run, scenario, walker

_PLAIN = (str, bytes, int, float, bool, type(None), np.generic)


def reachable(root: object) -> Iterator[object]:
    """Everything that attributes, items and bases of arrays lead to."""
    todo, seen = [root], {}
    while todo:
        item = todo.pop()
        # A log is the agent's own: what it writes there is its evidence.
        if id(item) in seen or isinstance(item, (*_PLAIN, AgentLog)) or callable(item):
            continue
        seen[id(item)] = item
        yield item
        if isinstance(item, np.ndarray):
            todo.append(item.base)
        elif isinstance(item, Mapping):
            todo += [*item.keys(), *item.values()]
        elif isinstance(item, (tuple, list, set, frozenset)):
            todo += list(item)
        for name in dir(type(item)):
            if not name.startswith("_") and type(item).__module__.startswith("drivora_service"):
                todo.append(getattr(item, name))


class Damage:
    """Writes to everything reachable, and counts what it wrote and what refused."""

    def __init__(self) -> None:
        self.written = 0
        self.refused = 0

    def do(self, root: object) -> None:
        for item in list(reachable(root)):
            self._write(item)

    def _write(self, item: Any) -> None:
        try:
            if isinstance(item, np.ndarray):
                item[...] = 77
            elif isinstance(item, MutableMapping):
                item.clear()
                item["parameter"] = 77
            elif isinstance(item, Mapping):
                for key in list(item):
                    item[key] = 77  # type: ignore[index]  # it tries
            elif isinstance(item, MutableSequence):
                item.clear()
            else:
                return
        except (ValueError, TypeError):
            self.refused += 1
        else:
            self.written += 1


class Idm:
    """Drives by ``idm`` with its own copies of what it is handed; the innocent twin."""

    def __init__(self, damage: Damage | None) -> None:
        self._driver = IdmAgent()
        self.damage = damage

    def setup_env(self, context: AgentContext) -> None:
        self._driver.setup_env(context)
        if self.damage is not None:
            self.damage.do(context)

    def run_step(self, observation: Observation) -> Control:
        control = self._driver.run_step(observation)
        if self.damage is not None:
            self.damage.do(observation)
            observation.ego = np.full(9, 77.0)
            observation.speed = observation.route_s = 77.0
        return control


def busy(weather: Weather | None = None) -> Scenario:
    on = "signal-grid"
    return scenario(
        ego(place("grand_1_1", 20, on=on), place("grand_3_2", 80, on=on), name="one"),
        ego(
            place("castle_1_1", 20, on=on), place("queen_3_1", 60, on=on), name="two",
            start_time=1.0,
        ),
        on=on,
        npc_vehicles=(
            car(place("grand_1_1", 60, on=on), place("grand_2_1", 60, on=on), name="reactive"),
        ),
        npc_walkers=(
            walker(place("grand_1_1", 90, on=on, right=6), place("grand_1_1", 90, on=on, right=-2)),
        ),
        background_traffic=BackgroundTraffic(count=10),
        weather=weather or Weather(),
        seconds=12.0,
    )  # fmt: skip


@pytest.mark.parametrize("weather", [Weather(), Weather(fog_density=60.0)])
def test_writing_to_everything_handed_over_changes_no_trace(weather: Weather) -> None:
    what = busy(weather)
    innocent = trace_sha256(run(what, Idm(None), Idm(None)))
    damage = Damage()
    assert trace_sha256(run(what, Idm(damage), Idm(damage))) == innocent
    # Its own copies took what was written; what is shared refused.
    assert damage.written > 1000
    assert damage.refused > 1000
    # Nor does it reach the runs that come after it in the same process.
    assert trace_sha256(run(what, Idm(None), Idm(None))) == innocent


def test_the_state_of_the_ego_is_the_agents_own() -> None:
    kept: list[np.ndarray] = []

    class Keeping:
        def setup_env(self, context: AgentContext) -> None:
            pass

        def run_step(self, observation: Observation) -> Control:
            kept.append(observation.ego)
            return AccelerationControl(1.0, 0.0)

    trace = run(scenario(ego(place("harbour_0_0", 20), place("harbour_0_0", 120))), Keeping())
    assert np.array_equal(np.array(kept), trace.states[: len(kept), 0])
    for array in kept:
        assert array.base is None
