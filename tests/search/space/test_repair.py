"""Moving starts apart."""

from __future__ import annotations

import math

import numpy as np
import pytest

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.routes.routing import RoutePoint, plan_route
from drivora_service.search.space.actor_starts import CLEAR_OF_EGO, Start, too_near
from drivora_service.search.space.driven_path import DrivenPath, Pose
from drivora_service.search.space.repair import STEP, Mover, other_choices, settle
from drivora_service.testing.networks import straight_road

ROAD = straight_road()
PATH = DrivenPath(ROAD, plan_route(ROAD, [RoutePoint(x=-400.0, y=0.0), RoutePoint(x=400.0, y=0.0)]))


def car(x: float, *, y: float = 0.0, speed: float = 0.0, clear: float = 2.0) -> Start:
    """A car of 4 m on the eastbound lane."""
    return Start(
        pose=Pose(x=x, y=y, yaw=0.0),
        length=4.0,
        width=2.0,
        speed=speed,
        path=PATH,
        s=x + 400.0,
        clear=clear,
    )


@pytest.mark.parametrize(("gap", "near"), [(1.9, True), (2.1, False)])
def test_two_cars_keep_two_metres(gap: float, near: bool) -> None:
    assert too_near(car(0.0), car(4.0 + gap)) is near
    assert too_near(car(4.0 + gap), car(0.0)) is near


@pytest.mark.parametrize(("gap", "near"), [(6.9, True), (7.1, False)])
def test_others_keep_clear_of_an_ego(gap: float, near: bool) -> None:
    ego = car(0.0, clear=CLEAR_OF_EGO)
    assert too_near(ego, car(4.0 + gap)) is near
    assert too_near(car(-4.0 - gap), ego) is near


def test_cars_may_start_side_by_side() -> None:
    assert not too_near(car(0.0), car(0.0, y=3.5))
    assert not too_near(car(0.0, clear=CLEAR_OF_EGO), car(1.0, y=3.5))


def test_a_fast_car_has_room_to_brake_for_a_slow_one() -> None:
    # 12² / (2 * 3) m to stop, half a second before, 2 m to spare, and two half cars.
    room = 24.0 + 6.0 + 2.0 + 4.0
    assert too_near(car(0.0, speed=12.0), car(room - 1.5))
    assert not too_near(car(0.0, speed=12.0), car(room + 1.5))
    assert not too_near(car(0.0, speed=12.0), car(room - 1.5, speed=12.0))
    assert not too_near(car(0.0, speed=12.0), car(room - 1.5, y=3.5))
    assert not too_near(car(0.0), car(room - 1.5, speed=12.0))


def test_an_ego_that_appears_after_the_other_has_left_is_not_near() -> None:
    later = Start(pose=Pose(x=0.0, y=0.0, yaw=0.0), length=1.0, width=1.0, appears=3.0, until=3.0)
    waiting = Start(pose=Pose(x=0.0, y=0.0, yaw=0.0), length=4.0, width=2.0, until=5.0)
    assert not too_near(later, car(0.0))
    assert too_near(later, waiting)


def mover(room: float = 100.0, alternatives: tuple[tuple[int, float], ...] = ()) -> Mover:
    """Gene 0 is the share of the room from x = 0 on, gene 1 the lateral place."""

    def start(values: FloatArray) -> Start:
        return car(float(values[0]) * room, y=float(values[1]))

    return Mover(start=start, room=lambda _values: room, shift_gene=0, alternatives=alternatives)


def test_an_actor_at_a_free_place_stays() -> None:
    values, taken = np.array([0.5, 0.0]), [car(0.0)]
    settle(values, mover(), taken)
    assert values.tolist() == [0.5, 0.0]
    assert taken[1].pose.x == 50.0


def test_it_moves_to_the_nearest_free_place() -> None:
    values, taken = np.array([0.5, 0.0]), [car(47.5)]
    settle(values, mover(), taken)
    assert values[0] == pytest.approx(0.5 + 2 * STEP / 100.0)
    assert not too_near(taken[0], taken[1])
    again = values.copy()
    settle(again, mover(), [car(47.5)])
    assert again.tolist() == values.tolist()


def test_it_moves_backwards_where_there_is_no_room_ahead() -> None:
    values, taken = np.array([1.0, 0.0]), [car(99.0)]
    settle(values, mover(), taken)
    assert values[0] == pytest.approx(1.0 - 4 * STEP / 100.0)


def test_an_alternative_is_taken_where_the_whole_path_is_taken() -> None:
    values, taken = np.array([0.3, 0.0]), [car(0.0)]
    settle(values, mover(4.0, alternatives=((1, 0.5), (1, 3.5))), taken)
    assert values.tolist() == [0.3, 3.5]


def test_an_actor_without_a_free_place_is_not_moved() -> None:
    values, taken = np.array([0.3, 0.0]), [car(0.0)]
    settle(values, mover(4.0, alternatives=((1, 0.5),)), taken)
    assert values.tolist() == [0.3, 0.0]
    assert len(taken) == 2


def test_a_refused_place_is_not_taken() -> None:
    plain = mover()
    picky = Mover(
        start=plain.start,
        room=plain.room,
        shift_gene=0,
        is_refused=lambda start: math.hypot(start.pose.x - 50.0, start.pose.y) < 5.0,
    )
    values = np.array([0.5, 0.0])
    settle(values, picky, [])
    assert values[0] == pytest.approx(0.5 + 3 * STEP / 100.0)


def test_other_choices_are_all_but_the_own() -> None:
    assert other_choices(1, np.array([0.0, 2.0]), 4) == ((1, 3.0), (1, 0.0), (1, 1.0))
