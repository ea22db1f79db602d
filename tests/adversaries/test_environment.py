"""The environment of an adversary, as Gymnasium wants it."""

from __future__ import annotations

import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.errors import SimulatorError
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.runs.adversary import ACTIONS, Action
from drivora_service.scenario.model import Scenario, Weather
from tests.adversaries.games import NUMBER, alone
from tests.simulation.episodes import network, run

pytest.importorskip("gymnasium", reason="an extra: `adversary`, and part of the development tools")


def environment(what: Scenario | None = None, interval: float = 4.0):  # type: ignore[no-untyped-def]  # Gymnasium may be missing
    from drivora_service.adversaries.environment import AdversaryEnv

    return AdversaryEnv(what or alone(), network(), AgentCatalogue(), interval=interval)


def test_gymnasium_s_checks_pass() -> None:
    from gymnasium.utils.env_checker import check_env

    with warnings.catch_warnings():
        # That it is not made by `gymnasium.make`, of which checks know nothing.
        warnings.filterwarnings("ignore", message=".*not within a registered.*|.*env\\.spec.*")
        check_env(environment(), skip_render_check=True)


def test_a_seed_repeats_an_episode_and_another_one_does_not() -> None:
    env = environment(alone(weather=Weather(fog_density=85.0, sun_altitude_angle=-10.0)))

    def played(seed: int | None) -> str:
        env.reset(seed=seed)
        for action in (Action.NOTHING, Action.VEHICLE_SLOW, Action.NIGHT):
            env.step(np.int64(NUMBER[action]))
        return trace_sha256(env.finish())

    first, then, again, other = played(7), played(None), played(7), played(8)
    assert first == again
    assert len({first, then, other}) == 3


def test_an_episode_is_the_run_of_its_scenario() -> None:
    env = environment()
    view, info = env.reset(seed=3)
    assert env.observation_space.contains(view)
    assert info == {"time": 0.0}
    done = False
    actions = iter((Action.HEAVY_RAIN, Action.RUNNER_RIGHT))
    while not done:
        action = np.int64(NUMBER[next(actions, Action.NOTHING)])
        view, reward, terminated, truncated, info = env.step(action)
        assert env.observation_space.contains(view)
        assert -1.0 <= reward <= 1.0
        done = terminated or truncated
    trace = env.finish()
    assert trace_sha256(run(env.scenario)) == trace_sha256(trace)
    assert info["intervention"]["action"] in ("nothing", "runner-right")
    assert trace.times[-1] == pytest.approx(info["time"])


def test_its_actions_are_those_of_the_catalogue() -> None:
    env = environment()
    assert env.action_space.n == len(ACTIONS)
    _, _, _, _, info = (env.reset(seed=1), env.step(np.int64(NUMBER[Action.FOG])))[1]
    assert info["intervention"] == {
        "time": 0.0, "action": "fog", "weather": {"fog_density": 80.0},
    }  # fmt: skip


def test_a_step_before_the_first_episode_is_refused() -> None:
    with pytest.raises(SimulatorError, match="reset"):
        environment().step(np.int64(0))


def test_without_gymnasium_the_extra_is_named(repository: Path) -> None:
    """In a process that cannot import it."""
    code = (
        "import sys; sys.modules['gymnasium'] = None\n"
        "from drivora_service.errors import ConfigurationError\n"
        "try:\n"
        "    import drivora_service.adversaries.environment\n"
        "except ConfigurationError as error:\n"
        "    print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=repository, capture_output=True, text=True, check=True
    )
    assert "pip install '.[adversary]'" in done.stdout
