"""Makes ``metadrive_ppo.npz``: what MetaDrive's own simulator shows its expert, and what that does.

Run in an environment of its own with ``metadrive-simulator`` 0.4.3 (Python 3.11)::

    python make_metadrive_reference.py metadrive_ppo.npz

Drives the expert through maps of MetaDrive's generator and keeps every 40th state: the observation
and the mean action by its own code, with the state of the scene that they belong to in the form
that ``encoding`` takes. Nothing is drawn, so empty files stand in for the pictures that MetaDrive
would download first.
"""

from __future__ import annotations

import logging
import math
import sys
from pathlib import Path

import metadrive
import numpy as np
from metadrive import MetaDriveEnv
from metadrive.component.lane.circular_lane import CircularLane
from metadrive.component.vehicle.base_vehicle import BaseVehicle
from metadrive.examples.ppo_expert.numpy_expert import expert
from metadrive.version import VERSION

MOST_OBJECTS = 40
EVERY = 40
SEEDS = range(200, 203)


def stand_in_for_pictures() -> None:
    assets = Path(metadrive.__file__).parent / "assets"
    picture = assets / "textures" / "grass1" / "GroundGrassGreen002_COL_1K.jpg"
    picture.parent.mkdir(parents=True, exist_ok=True)
    picture.touch()
    (assets / "version.txt").write_text(VERSION)


def middle_of_road(vehicle: BaseVehicle) -> list[float]:
    """x, y, direction of the road's middle beside the vehicle, width, number of lanes."""
    lanes = vehicle.navigation.current_ref_lanes
    width = lanes[0].width
    along, _ = lanes[0].local_coordinates(vehicle.position)
    x, y = lanes[0].position(along, (len(lanes) / 2 - 0.5) * width)
    along, _ = lanes[-1].local_coordinates(vehicle.position)
    return [x, y, lanes[-1].heading_theta_at(along), len(lanes) * width, len(lanes)]


def piece(vehicle: BaseVehicle, lanes: list) -> list[float]:
    """Checkpoint x and y, radius, angle to the left, width of the road."""
    navigation, lane = vehicle.navigation, lanes[0]
    width = navigation.get_current_lane_num() * navigation.get_current_lane_width()
    x, y = lane.position(lane.length, width / 2 - navigation.get_current_lane_width() / 2)
    if not isinstance(lane, CircularLane):
        return [x, y, 0.0, 0.0, width]
    return [x, y, lane.radius, -lane.angle if lane.is_clockwise() else lane.angle, width]


def main(path: Path) -> None:
    stand_in_for_pictures()
    env = MetaDriveEnv(
        {
            "use_render": False, "num_scenarios": len(SEEDS), "start_seed": SEEDS[0],
            "traffic_density": 0.15, "log_level": logging.ERROR,
        }
    )  # fmt: skip
    rows: dict[str, list] = {
        name: []
        for name in (
            "observation", "action", "ego", "speed", "place", "last", "pieces", "objects",
            "sizes", "count",
        )
    }  # fmt: skip
    for seed in SEEDS:
        env.reset(seed=seed)
        for step in range(1000):
            car = env.agent
            turned = math.remainder(
                car.heading_theta - math.atan2(*car.last_heading_dir[::-1]), 2 * math.pi
            )
            action, seen = expert(car, deterministic=True, need_obs=True)
            if step % EVERY == EVERY - 1:
                navigation = car.navigation
                following = navigation.next_ref_lanes or navigation.current_ref_lanes
                others = [
                    other
                    for other in env.engine.get_objects().values()
                    if isinstance(other, BaseVehicle) and other is not car
                ]
                others.sort(key=lambda o: np.hypot(*(o.position - car.position)))
                objects, sizes = np.zeros((MOST_OBJECTS, 9)), np.zeros((MOST_OBJECTS, 2))
                for row, other in enumerate(others[:MOST_OBJECTS]):
                    objects[row, :5] = [*other.position, other.heading_theta, *other.velocity]
                    sizes[row] = other.LENGTH, other.WIDTH
                rows["observation"].append(seen[0])
                rows["action"].append(action)
                rows["ego"].append(
                    [*car.position, car.heading_theta, *car.velocity, 0, 0, turned / 0.1, 0]
                )
                rows["speed"].append(car.speed)
                rows["place"].append(middle_of_road(car))
                rows["last"].append(car.last_current_action[1])
                rows["pieces"].append(
                    [piece(car, navigation.current_ref_lanes), piece(car, following)]
                )
                rows["objects"].append(objects)
                rows["sizes"].append(sizes)
                rows["count"].append(min(len(others), MOST_OBJECTS))
            _, _, ended, cut_off, _ = env.step(np.clip(action, -1, 1))
            if ended or cut_off:
                break
    arrays = {name: np.array(values) for name, values in rows.items()}
    arrays["observation"] = arrays["observation"].astype(np.float32)
    arrays["action"] = arrays["action"].astype(np.float32)
    np.savez_compressed(path, **arrays)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
