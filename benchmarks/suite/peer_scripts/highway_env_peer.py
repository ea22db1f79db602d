"""highway-env in an environment of its own: one round for every line of the input.

Arguments: vehicles beside the ego, the seconds to simulate, and if not the defaults the steps and
the decisions of the ego in a second. Each round answers with a line of
JSON. Setting up an episode is not timed, which favours the peer.
"""

from __future__ import annotations

import json
import sys
import time

import gymnasium
import highway_env

_IDLE = 1


def simulate(env: gymnasium.Env, seconds: float) -> tuple[float, float]:
    """Returns the seconds simulated, and the processor seconds that they took."""
    simulated = needed = 0.0
    env.reset(seed=0)
    while simulated < seconds:
        begun = time.process_time()
        _, _, terminated, truncated, _ = env.step(_IDLE)
        needed += time.process_time() - begun
        simulated += 1.0 / env.unwrapped.config["policy_frequency"]
        if terminated or truncated:
            env.reset()
    return simulated, needed


def main() -> None:
    """Answers every line of the input."""
    vehicles, seconds = int(sys.argv[1]), float(sys.argv[2])
    gymnasium.register_envs(highway_env)
    config = {"vehicles_count": vehicles, "duration": int(seconds)}
    if len(sys.argv) > 3:
        config["simulation_frequency"] = int(sys.argv[3])
        config["policy_frequency"] = int(sys.argv[4])
    env = gymnasium.make("highway-v0", config=config)
    env.reset(seed=0)
    count = len(env.unwrapped.road.vehicles) - 1
    for _ in sys.stdin:
        simulated, needed = simulate(env, seconds)
        print(json.dumps({"simulated": simulated, "needed": needed, "vehicles": count}), flush=True)


main()
