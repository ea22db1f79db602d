"""Hypothesis strategies for documents."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

coordinates = st.floats(-1e5, 1e5, allow_nan=False).map(lambda value: round(value, 3))
angles = st.floats(-360, 360, allow_nan=False)
speeds = st.floats(0, 10, allow_nan=False)
percentages = st.floats(0, 100, allow_nan=False)
times = st.floats(0, 100, allow_nan=False)
accelerations = st.floats(0.5, 12, allow_nan=False)
texts = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=8)
# Controls, formats and separators of lines are refused in names.
names = st.text(
    st.characters(exclude_categories=["Cc", "Cf", "Cs", "Zl", "Zp"]), min_size=1, max_size=8
)
json_values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**53), 2**53)
    | st.floats(allow_nan=False, allow_infinity=False)
    | texts,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(texts, inner, max_size=3),
    max_leaves=6,
)


def optional(**keys: st.SearchStrategy[Any]) -> dict[str, st.SearchStrategy[Any]]:
    """Names the strategies for ``fixed_dictionaries(optional=...)``."""
    return keys


waypoints = st.fixed_dictionaries(
    {"x": coordinates, "y": coordinates}, optional=optional(z=angles, yaw=angles, speed=speeds)
)
npc_waypoints = st.fixed_dictionaries(
    {"x": coordinates, "y": coordinates},
    optional=optional(z=angles, yaw=angles, speed=speeds, wait=times),
)
locations = st.fixed_dictionaries(
    {"x": coordinates, "y": coordinates}, optional=optional(z=angles, yaw=angles)
)
agents = st.fixed_dictionaries(
    {"name": st.sampled_from(["idm", "sumo-krauss"])},
    optional=optional(parameters=st.dictionaries(texts, json_values, max_size=2)),
)
light_times = st.fixed_dictionaries(
    {},
    optional=optional(
        green_time=st.floats(1, 60),
        red_time=st.floats(1, 60),
        yellow_time=st.floats(1, 60),
        offset=st.floats(-60, 60),
    ),
)


@st.composite
def _paths(draw: st.DrawFn) -> list[dict[str, float]]:
    moments = sorted(draw(st.sets(times, min_size=2, max_size=4)))
    pose = st.fixed_dictionaries(
        {"x": coordinates, "y": coordinates, "yaw": angles, "speed": speeds},
        optional=optional(z=angles),
    )
    return [{"time": moment, **draw(pose)} for moment in moments]


reference_paths: st.SearchStrategy[list[dict[str, float]]] = st.just([]) | _paths()


def routes(
    fewest: int, places: st.SearchStrategy[dict[str, Any]] = waypoints
) -> st.SearchStrategy[list[dict[str, Any]]]:
    """Lists of waypoints."""
    return st.lists(places, min_size=fewest, max_size=4)


@st.composite
def documents(draw: st.DrawFn) -> dict[str, Any]:
    """Documents that are valid as far as they go without a road network."""
    numbers = iter(range(100))

    def named(content: dict[str, Any]) -> dict[str, Any]:
        return {"id": f"actor_{next(numbers)}", **content}

    egos = st.fixed_dictionaries(
        {
            "model": st.sampled_from(["vehicle.audi.tt", "mkz2017", "lincoln.mkz_2020"]),
            "route": routes(2),
        },
        optional=optional(
            start_time=times, initial_speed=speeds, agent=agents, reference_path=reference_paths
        ),
    )
    vehicles = st.fixed_dictionaries(
        {"model": st.just("tesla.model3"), "route": routes(1, npc_waypoints)},
        optional=optional(
            start_time=times,
            behavior=st.sampled_from(["replay", "reactive", "sumo"]),
            at_end=st.sampled_from(["leave", "stay"]),
            deceleration=accelerations,
            lateral_acceleration=accelerations,
            joins=st.booleans(),
        ),
    )
    walkers = st.fixed_dictionaries(
        {"model": st.just("walker.pedestrian.0001"), "route": routes(1)},
        optional=optional(start_time=times, joins=st.booleans()),
    )
    obstacles = st.fixed_dictionaries(
        {"model": st.just("static.prop.trafficcone01"), "location": locations},
        optional=optional(length=st.floats(0.1, 10), width=st.floats(0.1, 10), start_time=times),
    )
    patches = st.fixed_dictionaries(
        {
            "location": locations,
            "length": st.floats(0.5, 50),
            "width": st.floats(0.5, 50),
            "friction": st.floats(0.02, 1),
        }
    )
    weather = st.fixed_dictionaries(
        {},
        optional=optional(
            wetness=percentages,
            fog_density=percentages,
            precipitation=percentages,
            sun_altitude_angle=st.floats(-90, 90),
        ),
    )
    content = draw(
        st.fixed_dictionaries(
            {"map_region": st.just({"town": "tee-town"})},
            optional=optional(
                version=st.just("1.0"),
                frame=st.sampled_from(["sumo", "carla"]),
                weather=weather,
                weather_changes=st.lists(
                    st.fixed_dictionaries({"time": times, "weather": weather}),
                    max_size=3,
                    unique_by=lambda change: change["time"],
                ).map(lambda changes: sorted(changes, key=lambda change: change["time"])),
                traffic_lights=light_times,
                background_traffic=st.fixed_dictionaries(
                    {"count": st.integers(0, 20)}, optional=optional(start_time=times)
                ),
                seed=st.integers(0, 2**31 - 1),
                step_length=st.sampled_from([0.01, 0.05, 0.1]),
                max_sim_time=st.floats(1, 100),
                extensions=st.dictionaries(
                    st.sampled_from(["acme:note", "org.example.data"]), json_values, max_size=2
                ),
            ),
        )
    )
    content["ego_vehicles"] = [named(ego) for ego in draw(st.lists(egos, min_size=1, max_size=2))]
    content["npc_vehicles"] = [named(npc) for npc in draw(st.lists(vehicles, max_size=2))]
    content["npc_walkers"] = [named(npc) for npc in draw(st.lists(walkers, max_size=2))]
    content["npc_obstacles"] = [named(npc) for npc in draw(st.lists(obstacles, max_size=2))]
    content["friction_patches"] = [named(one) for one in draw(st.lists(patches, max_size=2))]
    return content


ODD_KEYS = ("[key]", "", "/", "~", "~1", "0", "-1", "__class__", "model_fields", "\ud800")
"""That pointers, models or Python may take for something else."""


@st.composite
def garbled(draw: st.DrawFn, valid: st.SearchStrategy[dict[str, Any]]) -> dict[str, Any]:
    """A valid document in which a few places were replaced, removed or added to."""
    content = draw(valid)
    for _ in range(draw(st.integers(1, 3))):
        place: Any = content
        while isinstance(place, dict | list) and place:
            keys = list(place) if isinstance(place, dict) else list(range(len(place)))
            key = draw(st.sampled_from(keys))
            if not isinstance(place[key], dict | list) or draw(st.booleans()):
                change = draw(st.sampled_from(["replace", "remove", "add"]))
                if change == "replace":
                    place[key] = draw(json_values | st.floats() | st.integers())
                elif change == "remove":
                    del place[key]
                elif isinstance(place, dict):
                    place[draw(st.text(max_size=5) | st.sampled_from(ODD_KEYS))] = draw(json_values)
                break
            place = place[key]
    return content
