"""The Leaderboard's penalties and what it charges, with values computed by hand."""

from __future__ import annotations

from typing import Any

import pytest

from drivora_service.metrics.driving_score import Version, infraction_penalty
from drivora_service.metrics.infractions import Infractions, counted_collisions
from drivora_service.metrics.judgement import Judgement
from drivora_service.observations.trace import Contact, Role, TerminalEvent
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.testing.traces import SyntheticActor
from tests.metrics.streets import ego_on_road, straight, values_of


@pytest.mark.parametrize(
    ("infractions", "v1_0", "v2_0", "v2_1"),
    [
        (Infractions(), 1.0, 1.0, 1.0),
        (Infractions(pedestrian=1), 0.5, 0.5, 1 / 2),
        (Infractions(vehicle=1), 0.6, 0.6, 1 / 1.7),
        (Infractions(static=1), 0.65, 0.65, 1 / 1.6),
        (Infractions(red_light=1), 0.7, 0.7, 1 / 1.4),
        (Infractions(stop_sign=1), 0.8, 0.8, 1 / 1.25),
        (Infractions(scenario_timeout=1), 1.0, 0.7, 1 / 1.4),
        (Infractions(slow=(0.5,)), 1.0, 0.85, 1 / 1.2),
        (Infractions(slow=(0.5, 0.0)), 1.0, 0.85 * 0.7, 1 / 1.6),
        (Infractions(outside=0.25), 0.75, 0.75, 0.75),
        (Infractions(red_light=3), 0.343, 0.343, 1 / 2.2),
        (
            Infractions(vehicle=1, red_light=2, stop_sign=1, slow=(0.9,), outside=0.1),
            0.6 * 0.49 * 0.8 * 0.9,
            0.6 * 0.49 * 0.8 * 0.97 * 0.9,
            0.9 / (1 + 0.7 + 0.8 + 0.25 + 0.04),
        ),
    ],
)
def test_penalties(infractions: Infractions, v1_0: float, v2_0: float, v2_1: float) -> None:
    found = [infraction_penalty(infractions, version) for version in Version]
    assert found == pytest.approx([v1_0, v2_0, v2_1])


def collision(time: float, x: float, other: str = "npc", speed: float = 5.0) -> Verdict:
    return Verdict(
        oracle="collision",
        ego="ego",
        outcome=Outcome.VIOLATED,
        message="",
        time=time,
        location=(x, 0.0),
        counterpart=other,
        evidence={"ego_speed": speed, "counterpart_role": "npc_vehicle"},
    )


@pytest.mark.parametrize(
    ("collisions", "counted"),
    [
        ([collision(1.0, 0.0), collision(1.0, 0.0, "two")], [0]),
        ([collision(1.0, 0.0), collision(2.0, 5.0, "two")], [0]),
        ([collision(1.0, 0.0), collision(2.0, 5.1, "two")], [0, 1]),
        # One that is not counted does not move the circle.
        ([collision(1.0, 0.0), collision(2.0, 4.0, "two"), collision(3.0, 8.0, "three")], [0, 2]),
        ([collision(1.0, 0.0), collision(6.0, 40.0)], [0]),
        ([collision(1.0, 0.0), collision(6.1, 40.0)], [0, 1]),
        ([collision(1.0, 0.0, speed=0.09), collision(1.0, 0.0, "two")], [1]),
        ([collision(9.0, 90.0, "late"), collision(1.0, 0.0)], [1, 0]),
    ],
)
def test_collisions_that_count(collisions: list[Verdict], counted: list[int]) -> None:
    found = counted_collisions(Judgement(verdicts=tuple(collisions)))
    assert found == tuple(collisions[k] for k in counted)


def obstacle(x: float, name: str, role: Role = Role.NPC_OBSTACLE) -> SyntheticActor:
    return SyntheticActor(id=name, motion=straight(0.0, 200, x), role=role, length=1.0)


def test_two_actors_hit_at_once_are_one_collision() -> None:
    ego = ego_on_road(
        straight(8.0, 200), 70.0, end=TerminalEvent.COLLISION, end_step=93
    )  # x = 37.2: the front at 39.45 m, both obstacles at 39.4 m
    others = (obstacle(39.9, "cone"), obstacle(39.9, "walker", Role.NPC_WALKER))
    contacts = [Contact(step=93, ego=0, other=1), Contact(step=93, ego=0, other=2)]
    values = values_of(ego, *others, contacts=contacts)
    completion = 100.0 * 37.2 / 70.0
    assert values["route_completion"] == pytest.approx(completion)
    assert values["driving_score_1_0"] == pytest.approx(0.65 * completion)
    assert values["driving_score_2_0"] == pytest.approx(0.65 * completion)
    assert values["driving_score"] == pytest.approx(completion / 1.6)
    assert values["success"] == 0.0


def test_an_ego_that_was_never_there_is_charged_with_nothing_and_completes_nothing() -> None:
    values: dict[str, Any] = values_of(ego_on_road(straight(8.0, 50), 70.0, start_time=90.0))
    assert (values["infraction_penalty"], values["driving_score"]) == (1.0, 0.0)
