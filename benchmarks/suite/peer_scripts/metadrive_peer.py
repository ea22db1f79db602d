"""MetaDrive in an environment of its own: one round for every line of the input.

Arguments: vehicles beside the ego, and the seconds to simulate. Each round answers with a line of
JSON. The density of traffic is set so that there are that many vehicles or the next possible number
of them. Setting up an episode is not timed, which favours the peer.
"""

from __future__ import annotations

import json
import logging
import os
import sys
import time

# It prints while it starts; the answers have the output for themselves.
_answers = os.fdopen(os.dup(1), "w", buffering=1)
os.dup2(2, 1)

from metadrive import MetaDriveEnv  # noqa: E402  # after the output is set aside

_STEP_S = 0.1
_COAST = (0.0, 0.0)
_TRIES = 10


def open_env(density: float) -> MetaDriveEnv:
    """Returns an environment on a long straight road with a density of traffic."""
    env = MetaDriveEnv(
        {
            "use_render": False,
            "num_scenarios": 1,
            "map": "SSSSSS",
            "traffic_density": density,
            "traffic_mode": "respawn",
            "log_level": logging.ERROR,
            "horizon": None,
        }
    )
    env.reset(seed=0)
    return env


def count(env: MetaDriveEnv) -> int:
    """Returns the number of vehicles of the traffic."""
    return len(env.engine.traffic_manager.vehicles) - 1


def with_vehicles(vehicles: int) -> MetaDriveEnv:
    """Returns an environment with that many vehicles, found by bisection of the density."""
    low, high = 0.0, 1.0
    best = high
    for _ in range(_TRIES):
        middle = (low + high) / 2
        env = open_env(middle)
        found = count(env)
        env.close()
        if found >= vehicles:
            best = high = middle
        else:
            low = middle
        if found == vehicles:
            break
    return open_env(best)


def simulate(env: MetaDriveEnv, seconds: float) -> tuple[float, float]:
    """Returns the seconds simulated, and the processor seconds that they took."""
    simulated = needed = 0.0
    while simulated < seconds:
        begun = time.process_time()
        _, _, terminated, truncated, _ = env.step(_COAST)
        needed += time.process_time() - begun
        simulated += _STEP_S
        if terminated or truncated:
            env.reset(seed=0)
    return simulated, needed


def main() -> None:
    """Answers every line of the input."""
    env = with_vehicles(int(sys.argv[1]))
    vehicles = count(env)
    for _ in sys.stdin:
        simulated, needed = simulate(env, float(sys.argv[2]))
        answer = {"simulated": simulated, "needed": needed, "vehicles": vehicles}
        _answers.write(json.dumps(answer) + "\n")


main()
