"""Makes ``smarts_agents.npz``: what the SMARTS policies answer to SMARTS's own observations.

In two steps. With Drivora, from its folder: records what an ego perceives between others::

    PYTHONPATH=. python tests/agents/data/make_smarts_reference.py record seen

In the environment that ``drivora agents install smarts-iamp`` has made, with a folder on
``PYTHONPATH`` in which there is ``drivora_service`` alone: asks the policies, with the classes of
the package ``smarts`` in place of the adapter's::

    python make_smarts_reference.py answer seen smarts_agents.npz
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

COLUMNS = (
    "time", "step", "speed", "acceleration", "steer", "route_s", "route_lateral",
    "light_distance", "speed_limit",
)  # fmt: skip
MOST_OBJECTS = 12


def record(folder: Path) -> None:
    from drivora_service.agents.idm.agent import IdmAgent
    from drivora_service.agents.remote.remote_messages import setup_request
    from tests.agents.smarts_scenario import smarts_scenario
    from tests.simulation.episodes import run

    class Recording(IdmAgent):
        def setup_env(self, context):
            super().setup_env(context)
            folder.mkdir(parents=True, exist_ok=True)
            (folder / "setup").write_bytes(setup_request(context, "run").SerializeToString())

        def run_step(self, observation):
            order = np.argsort(np.hypot(*(observation.objects[:, :2] - observation.ego[:2]).T))
            order = order[:MOST_OBJECTS]
            objects, sizes = np.zeros((MOST_OBJECTS, 9)), np.zeros((MOST_OBJECTS, 2))
            ids = np.zeros(MOST_OBJECTS, dtype=np.int64)
            objects[: len(order)] = observation.objects[order]
            sizes[: len(order)] = observation.object_sizes[order]
            ids[: len(order)] = observation.object_ids[order]
            rows["numbers"].append([float(getattr(observation, name)) for name in COLUMNS])
            rows["ego"].append(observation.ego.copy())
            rows["objects"].append(objects)
            rows["sizes"].append(sizes)
            rows["ids"].append(ids)
            rows["count"].append(len(order))
            return super().run_step(observation)

    rows = {name: [] for name in ("numbers", "ego", "objects", "sizes", "ids", "count")}
    run(smarts_scenario(seconds=14.0), Recording(1.0))
    np.savez(folder / "seen.npz", **{name: np.array(values) for name, values in rows.items()})


def answer(folder: Path, path: Path) -> None:
    from drivora_service.agents.adapters.smarts_agents import adapter
    from drivora_service.agents.interface import Observation
    from drivora_service.agents.log import AgentLog
    from drivora_service.agents.remote import agent_pb2 as pb
    from drivora_service.agents.remote.adapter_messages import context_view

    seen = dict(np.load(folder / "seen.npz"))
    request = pb.SetupRequest()
    request.ParseFromString((folder / "setup").read_bytes())
    answers = {}
    for name in ("iamp", "dsac", "casl"):
        ours = adapter.SmartsAdapter(name)
        ours.setup_env(context_view(request, AgentLog()))
        policy = ours._policy
        ours._policy = type("", (), {"act": lambda _, scene, p=policy: p.act(theirs(scene))})()
        answers[name] = []
        for k in range(len(seen["ego"])):
            count = int(seen["count"][k])
            observation = Observation(
                **dict(zip(COLUMNS, seen["numbers"][k].tolist(), strict=True)),
                ego=seen["ego"][k],
                objects=seen["objects"][k][:count],
                object_sizes=seen["sizes"][k][:count],
                object_kinds=np.zeros(count, dtype=np.int64),
                object_ids=seen["ids"][k][:count],
            )
            answers[name].append(tuple(ours.run_step(observation))[:3])
    np.savez_compressed(path, **seen, **{name: np.array(a) for name, a in answers.items()})


def theirs(scene):
    """Returns a scene as an observation of SMARTS."""
    from smarts.core.coordinates import Dimensions, Heading, RefLinePoint
    from smarts.core.events import Events
    from smarts.core.observations import EgoVehicleObservation, Observation, VehicleObservation
    from smarts.core.road_map import Waypoint

    ego = scene.ego_vehicle_state
    none = dict.fromkeys(Events._fields, False) | {"collisions": ()}

    def box(size):
        return Dimensions(size.length, size.width, size.height)

    def on_lane(place):
        return RefLinePoint(place.s, place.t, 0.0)

    return Observation(
        **dict.fromkeys(Observation._fields),
    )._replace(
        dt=0.1,
        step_count=scene.steps_completed,
        steps_completed=scene.steps_completed,
        elapsed_sim_time=scene.elapsed_sim_time,
        events=Events(**none),
        under_this_agent_control=True,
        distance_travelled=scene.distance_travelled,
        lidar_point_cloud=scene.lidar_point_cloud,
        ego_vehicle_state=EgoVehicleObservation(
            **dict.fromkeys(EgoVehicleObservation._fields)
        )._replace(
            id=ego.id, position=ego.position, bounding_box=box(ego.bounding_box),
            heading=Heading(ego.heading), speed=ego.speed, steering=ego.steering,
            yaw_rate=ego.yaw_rate, lane_id=ego.lane_id, lane_index=ego.lane_index,
            mission=ego.mission, linear_velocity=ego.linear_velocity,
            angular_velocity=ego.angular_velocity, linear_acceleration=ego.linear_acceleration,
            angular_acceleration=ego.angular_acceleration, linear_jerk=ego.linear_jerk,
            angular_jerk=ego.angular_jerk, lane_position=on_lane(ego.lane_position),
        ),
        neighborhood_vehicle_states=tuple(
            VehicleObservation(**dict.fromkeys(VehicleObservation._fields))._replace(
                id=other.id, position=other.position, bounding_box=box(other.bounding_box),
                heading=Heading(other.heading), speed=other.speed, lane_id=other.lane_id,
                lane_index=other.lane_index, lane_position=on_lane(other.lane_position),
            )
            for other in scene.neighborhood_vehicle_states
        ),
        waypoint_paths=[
            [
                Waypoint(
                    pos=point.pos, heading=Heading(point.heading), lane_id=point.lane_id,
                    lane_width=point.lane_width, speed_limit=point.speed_limit,
                    lane_index=point.lane_index, lane_offset=point.lane_offset,
                )
                for point in path
            ]
            for path in scene.waypoint_paths
        ],
    )  # fmt: skip


if __name__ == "__main__":
    if sys.argv[1] == "record":
        record(Path(sys.argv[2]))
    else:
        answer(Path(sys.argv[2]), Path(sys.argv[3]))
