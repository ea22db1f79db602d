"""Makes ``puffer_drive.npz``: PufferLib's own scenes, observations and answers to them.

Run in an environment of its own with ``torch``, ``numpy``, ``gymnasium``, ``gym`` and a C compiler,
on the unpacked source archive of ``pufferlib`` 3.0.0 (building it is not needed)::

    PYTHONPATH=pufferlib-3.0.0 python make_puffer_reference.py pufferlib-3.0.0 puffer_drive.npz

Its simulator, compiled from its C header, plays the map that the archive brings; its network drives
all vehicles. Printed is how many reach their goal and how many collide. Stored are, of the first
vehicles, what the simulator showed at the first eight steps with the network's logits, and the
state of the scene at the start in the form that ``encoding`` takes, in full size.
"""

from __future__ import annotations

import ctypes
import subprocess
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import torch
from gymnasium import spaces
from pufferlib.models import LSTMWrapper
from pufferlib.ocean.torch import GPUDrive

STEPS, STORED_STEPS, STORED_VEHICLES = 90, 8, 3
SHRUNK = 0.7

HARNESS = r"""
#include "gpudrive.h"
#define API __attribute__((visibility("default")))
static GPUDrive env;
API int begin(const char* map) {
    env.map_name = strdup(map);
    env.dynamics_model = CLASSIC;
    env.num_agents = MAX_CARS;
    env.spawn_immunity_timer = 50;
    allocate(&env);
    c_reset(&env);
    return env.active_agent_count;
}
API float* seen(void) { return env.observations; }
API void step(int* actions) {
    memcpy(env.actions, actions, env.active_agent_count * 2 * sizeof(int));
    c_step(&env);
}
API int others(void) { return env.static_car_count; }
API void state(int row, float* out) {
    int active = env.active_agent_count;
    Entity* e = &env.entities[row < active ? env.active_agent_indices[row]
                                           : env.static_car_indices[row - active]];
    float values[11] = {e->x, e->y, e->heading, e->vx, e->vy, e->length, e->width,
        e->goal_position_x, e->goal_position_y, e->collision_state, e->reached_goal_this_episode};
    memcpy(out, values, sizeof values);
}
"""


def compile_simulator(source: Path, folder: Path) -> ctypes.CDLL:
    code, library = folder / "harness.c", folder / "harness.so"
    code.write_text(HARNESS)
    (raylib,) = source.glob("raylib-*linux*/include")
    # What draws is left out by the linker: nothing here calls it.
    subprocess.run(
        [
            "gcc", "-O1", "-w", "-shared", "-fPIC", "-fvisibility=hidden", "-ffunction-sections",
            "-fdata-sections", "-Wl,--gc-sections", f"-I{source / 'pufferlib/ocean/gpudrive'}",
            f"-I{raylib}", str(code), "-o", str(library), "-lm",
        ],
        check=True,
    )  # fmt: skip
    simulator = ctypes.CDLL(str(library))
    simulator.seen.restype = ctypes.POINTER(ctypes.c_float)
    return simulator


def load_network(source: Path) -> LSTMWrapper:
    env = SimpleNamespace(
        single_observation_space=spaces.Box(-1, 1, (1847,), np.float32),
        single_action_space=spaces.MultiDiscrete([7, 13]),
    )
    network = LSTMWrapper(env, GPUDrive(env, input_size=64, hidden_size=512), 512, 512)
    numbers = np.fromfile(
        source / "pufferlib/resources/gpudrive/gpudrive_weights.bin", dtype=np.float32
    )
    at = 0
    for _, parameter in network.named_parameters():
        part = numbers[at : at + parameter.numel()].reshape(tuple(parameter.shape))
        parameter.data.copy_(torch.from_numpy(part.copy()))
        at += parameter.numel()
    assert at == len(numbers)
    return network


def states(simulator: ctypes.CDLL, count: int) -> np.ndarray:
    rows = np.zeros((count, 11), dtype=np.float32)
    for row in range(count):
        simulator.state(row, rows[row].ctypes.data_as(ctypes.c_void_p))
    return rows


@torch.no_grad()
def main(source: Path, path: Path) -> None:
    with tempfile.TemporaryDirectory() as folder:
        simulator = compile_simulator(source, Path(folder))
    network = load_network(source)
    count = simulator.begin(str(source / "pufferlib/resources/gpudrive/map_942.bin").encode())
    everybody = count + simulator.others()
    state = {"lstm_h": None, "lstm_c": None}
    collided, reached = np.zeros(count, bool), np.zeros(count, bool)
    stored_seen, stored_logits = [], []
    scene = states(simulator, everybody)
    for step in range(STEPS):
        seen = np.ctypeslib.as_array(simulator.seen(), (count, 1847)).copy()
        logits, _ = network.forward_eval(torch.from_numpy(seen), state)
        if step < STORED_STEPS:
            stored_seen.append(seen[:STORED_VEHICLES])
            stored_logits.append(torch.cat(logits, dim=1)[:STORED_VEHICLES].numpy())
        actions = np.array([part.argmax(dim=1).numpy() for part in logits], dtype=np.int32).T
        actions = np.ascontiguousarray(actions)
        simulator.step(actions.ctypes.data_as(ctypes.c_void_p))
        now = states(simulator, count)
        collided |= now[:, 9] > 0
        reached |= now[:, 10] > 0
    print(f"{count} vehicles: {reached.sum()} reached their goal, {collided.sum()} collided")
    rows = scene[:, :5].astype(np.float64)
    np.savez_compressed(
        path,
        observation=np.array(stored_seen).swapaxes(0, 1),
        logits=np.array(stored_logits).swapaxes(0, 1),
        states=np.column_stack((rows, np.zeros((len(rows), 4)))),
        sizes=scene[:, 5:7].astype(np.float64) / SHRUNK,
        goals=scene[:STORED_VEHICLES, 7:9].astype(np.float64),
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
