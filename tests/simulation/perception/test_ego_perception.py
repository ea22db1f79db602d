"""What an ego perceives of others who hide one another."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.outlines import box_corners
from drivora_service.observations.sight import is_hidden
from drivora_service.observations.trace import Col
from drivora_service.scenario.model import Weather
from drivora_service.scenario.weather import weather_effects
from drivora_service.simulation.perception.ego_perception import (
    Draw,
    Sense,
    empty_seen,
    perceive,
)
from drivora_service.simulation.plans.plan_arrays import privileged_senses, senses_of
from drivora_service.simulation.world import WorldFrames

CAR, VAN, WALKER = (4.5, 1.8, 1.5), (6.0, 2.0, 2.3), (0.4, 0.4, 1.7)
"""Length, width and height, metres."""

Figure = tuple[tuple[float, float, float], tuple[float, float, float]]
"""x, y and yaw of an actor, and its size."""


def world(*actors: Figure) -> tuple[FloatArray, FloatArray, FloatArray]:
    states = np.zeros((len(actors), len(Col)))
    states[:, :3] = [place for place, _ in actors]
    sizes = np.array([size for _, size in actors])
    return states, sizes[:, :2].copy(), sizes[:, 2].copy()


def hidden(*actors: Figure) -> bool:
    """Whether the second is hidden from the first."""
    states, sizes, heights = world(*actors)
    return is_hidden(0, 1, states, np.ones(len(actors), dtype=np.bool_), sizes, heights)


def seen(senses: FloatArray, *frames: tuple[Figure, ...]) -> FloatArray:
    """Returns what the first perceives at the last of the frames."""
    states, sizes, heights = world(*frames[-1])
    history = np.stack([world(*frame)[0] for frame in frames])
    count = len(states)
    out = empty_seen(count)
    found = perceive(
        0, len(frames) - 1,
        WorldFrames(history, np.ones((len(frames), count), dtype=np.bool_), sizes), heights,
        np.zeros(count, dtype=np.int64), senses, np.zeros((count, len(Draw))), out,
        np.zeros(count, dtype=np.int64),
    )  # fmt: skip
    return out.states[:found]


EGO: Figure = ((0.0, 0.0, 0.0), CAR)


def test_a_walker_behind_a_van_is_hidden_and_beside_it_is_not() -> None:
    van = ((15.0, 0.0, math.pi / 2), VAN)
    assert hidden(EGO, ((20.0, 0.0, 0.0), WALKER), van)
    assert not hidden(EGO, ((20.0, 6.0, 0.0), WALKER), van)
    assert not hidden(EGO, ((10.0, 0.0, 0.0), WALKER), van)


def test_part_of_an_actor_is_enough() -> None:
    van = ((15.0, 0.0, 0.0), VAN)
    assert not hidden(EGO, ((30.0, 0.0, math.pi / 2), VAN), van)
    assert hidden(EGO, ((30.0, 0.0, 0.0), CAR), van)


def test_one_sees_over_what_is_low() -> None:
    assert not hidden(EGO, ((20.0, 0.0, 0.0), WALKER), ((15.0, 0.0, 0.0), CAR))
    # A child has its head below the line from the roof over the bonnet of a car nearby.
    child = ((17.5, 0.0, 0.0), (0.4, 0.4, 1.2))
    assert hidden(EGO, child, ((15.0, 0.0, 0.0), CAR))


def test_a_tall_ego_sees_over_a_van() -> None:
    bus: Figure = ((0.0, 0.0, 0.0), (10.0, 2.5, 3.1))
    van = ((15.0, 0.0, 0.0), VAN)
    assert not hidden(bus, ((60.0, 0.0, 0.0), (9.0, 2.5, 3.2)), van)
    assert hidden(bus, ((19.0, 0.0, 0.0), WALKER), van)


def test_an_actor_on_another_level_hides_no_other() -> None:
    states, sizes, heights = world(EGO, ((20.0, 0.0, 0.0), WALKER), ((15.0, 0.0, 0.0), VAN))
    states[2, Col.Z] = 6.0
    assert not is_hidden(0, 1, states, np.ones(3, dtype=np.bool_), sizes, heights)


def test_an_absent_actor_hides_no_other() -> None:
    states, sizes, heights = world(EGO, ((20.0, 0.0, 0.0), WALKER), ((15.0, 0.0, 0.0), VAN))
    present = np.array([True, True, False])
    assert not is_hidden(0, 1, states, present, sizes, heights)


places = st.tuples(st.floats(-40, 40), st.floats(-40, 40), st.floats(-math.pi, math.pi))
figures = st.tuples(places, st.sampled_from([CAR, VAN, WALKER]))


@settings(max_examples=200)
@given(other=figures, between=st.lists(figures, max_size=4))
def test_tall_walls_hide_as_lines_of_sight_say(other: Figure, between: list[Figure]) -> None:
    # If every actor between is taller than all lines of sight, it is a matter of the plane.
    walls = [(place, (*size[:2], 9.0)) for place, size in between]
    actors = [EGO, other, *walls]
    states, sizes, _ = world(*actors)
    corners = [
        box_corners(*(state[None, k] for k in (Col.X, Col.Y, Col.YAW)), *size)[0]
        for state, size in zip(states, sizes.tolist(), strict=True)
    ]
    boxes = [shapely.Polygon(box) for box in corners[2:]]
    points = [states[1, :2], *corners[1]]
    lines = [shapely.LineString([states[0, :2], point]) for point in points]
    depth = [max((line.intersection(box).length for box in boxes), default=0.0) for line in lines]
    assume(not any(0.0 < cut < 1e-6 for cut in depth))
    assume(all(line.length > 1e-3 for line in lines))
    assert hidden(*actors) == (min(depth) > 0.0)


@settings(max_examples=100)
@given(other=figures, between=st.lists(figures, max_size=3), more=figures)
def test_more_actors_never_show_more(other: Figure, between: list[Figure], more: Figure) -> None:
    assert hidden(EGO, other, *between) <= hidden(EGO, other, *between, more)


def test_clear_weather_keeps_nothing_but_the_hidden_and_the_far() -> None:
    clear = senses_of(weather_effects(Weather()), 0.05)
    frame = (EGO, ((20.0, 0.0, 0.0), WALKER), ((15.0, 0.0, 0.0), VAN), ((0.0, 170.0, 0.0), CAR))
    assert seen(clear, frame)[:, Col.X].tolist() == [15.0]
    assert seen(privileged_senses(), frame)[:, Col.X].tolist() == [20.0, 15.0, 0.0]


def test_what_is_perceived_in_the_worst_weather_is_late() -> None:
    worst = weather_effects(Weather(fog_density=100.0, sun_altitude_angle=-90.0))
    senses = senses_of(worst, 0.05)
    assert senses[Sense.LAG] == round(worst.latency / 0.05) >= 5
    senses[[Sense.POSITION_NOISE, Sense.SPEED_NOISE, Sense.DROPOUT]] = 0.0
    frames = [(EGO, ((0.5 * k, 5.0, 0.0), CAR)) for k in range(10)]
    lag = int(senses[Sense.LAG])
    assert seen(senses, *frames)[0, Col.X] == pytest.approx(0.5 * (9 - lag))
    assert seen(senses, *frames[:2])[0, Col.X] == 0.0
