from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drivora_service.metrics.built_in_metrics import measure
from drivora_service.metrics.driving_score import Version, infraction_penalty
from drivora_service.metrics.infractions import infractions_of
from drivora_service.metrics.judgement import Judgement
from drivora_service.metrics.success import success
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import (
    Contact,
    Light,
    Role,
    TerminalEvent,
    Trace,
)
from drivora_service.oracles.built_in import default_oracles, judge_all
from drivora_service.oracles.verdict import Outcome
from drivora_service.testing.networks import EAST, straight_road
from drivora_service.testing.oracle_contract import example_runs
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace
from tests.oracles.streets import along, on_network, steady, way
from tests.simulation.episodes import network

ROAD = straight_road()
STEPS, SPEED = 240, 8.0
ROUTE = np.array([(0.0, 0.0), (90.0, 0.0)])


def driver(**fields: Any) -> SyntheticEgo:
    """An ego that arrives after 90 m without a fault, unless told otherwise."""
    defaults: dict[str, Any] = {
        "motion": Motion.steady(0.0, 0.0, steps=STEPS, speed=SPEED),
        "lane": EAST,
        "lane_lateral": 0.0,
        "lane_heading": 0.0,
        "speed_limit": 10.0,
        "route": ROUTE,
        "end": TerminalEvent.ARRIVED,
    }
    return SyntheticEgo(**{**defaults, **fields})


def measured(
    *egos: SyntheticEgo,
    others: Sequence[SyntheticActor] = (),
    contacts: Sequence[Contact] = (),
) -> dict[str, float | None]:
    return _measure(make_trace(egos, others, contacts=contacts))


def _measure(trace: Trace) -> dict[str, float | None]:
    return measure(trace, ROAD, judge_all(trace, ROAD, default_oracles()))


def standing(role: Role, place: float = 40.0) -> SyntheticActor:
    return SyntheticActor(id=role, motion=Motion.steady(place, 0.0, steps=STEPS), role=role)


CRASH = Contact(step=89, ego=0, other=1)


def test_a_drive_without_fault() -> None:
    values = measured(driver())
    for name in ("driving_score", "driving_score_1_0", "driving_score_2_0", "route_completion"):
        assert values[name] == 100.0
    for name in ("infraction_penalty", "success", "comfort"):
        assert values[name] == 1.0
    parts = {name: value for name, value in values.items() if name.startswith("nuplan_")}
    # The limit is 10 m/s: a free drive gains 2 m/s within 1.11 s and 10 m, and takes 8 s for the
    # other 80 m. The ego, at 8 m/s, has driven 72.9 m of the 90 m by then.
    progress = parts.pop("nuplan_progress_to_free_flow")
    assert progress is not None
    assert progress == pytest.approx(8.0 * (2.0 / 1.8 + 8.0) / 90.0)
    assert parts.pop("nuplan_closed_loop") == pytest.approx((5.0 * progress + 11.0) / 16.0)
    assert parts == dict.fromkeys(parts, 1.0)
    assert len(parts) == 7
    assert values["mean_speed_mps"] == pytest.approx(SPEED)
    assert values["distance_m"] == pytest.approx(SPEED * (STEPS - 1) * 0.05)


def test_what_needs_others_is_not_measurable_alone() -> None:
    values = measured(driver())
    for name in (
        "efficiency",
        "min_gap_m",
        "min_time_to_collision_s",
        "post_encroachment_time_s",
        "max_drac_mps2",
        "rss_violation_share",
    ):
        assert values[name] is None


@pytest.mark.parametrize(
    ("role", "version_1", "version_2_1"),
    [
        (Role.NPC_WALKER, 0.5, 1.0 / 2.0),
        (Role.NPC_OBSTACLE, 0.65, 1.0 / 1.6),
    ],
)
def test_the_tariff_of_a_collision(role: Role, version_1: float, version_2_1: float) -> None:
    values = measured(driver(), others=[standing(role)], contacts=[CRASH])
    assert values["driving_score_1_0"] == pytest.approx(100.0 * version_1)
    assert values["driving_score_2_0"] == pytest.approx(100.0 * version_1)
    assert values["driving_score"] == pytest.approx(100.0 * version_2_1)
    assert values["infraction_penalty"] == pytest.approx(version_2_1)
    assert values["success"] == 0.0


def test_events_multiply_in_the_old_rules_and_add_up_in_the_new() -> None:
    distance = np.where(np.arange(STEPS) < 20, 3.0 - 0.4 * np.arange(STEPS), np.nan)
    others = [standing(Role.NPC_WALKER), standing(Role.NPC_OBSTACLE, 60.0)]
    values = measured(
        driver(light=Light.RED, light_distance=distance),
        others=others,
        contacts=[CRASH, Contact(step=140, ego=0, other=2)],
    )
    assert values["driving_score_1_0"] == pytest.approx(100.0 * 0.5 * 0.65 * 0.7)
    assert values["driving_score"] == pytest.approx(100.0 / (1.0 + 1.0 + 0.6 + 0.4))


def test_a_stop_sign_costs_what_the_leaderboard_takes() -> None:
    town = network("tee-town")
    line = way(town, "-market_2_0", "-market_1_0")
    ego = on_network(
        town,
        along(line, steady(8.0, STEPS)),
        route=line,
        route_s=steady(8.0, STEPS) - 2.25,
        end=TerminalEvent.ARRIVED,
    )
    trace = make_trace([ego])
    view = RunView(trace, town)
    verdicts = judge_all(trace, town, default_oracles(), view=view)
    judgement = Judgement.of("ego", verdicts)
    assert len(judgement.violations("stop_sign") or ()) == 1
    assert success(judgement) == 0.0
    charged = infractions_of(view.egos[0], judgement)
    assert charged is not None
    penalties = [
        infraction_penalty(charged, version)
        for version in (Version.V1_0, Version.V2_0, Version.V2_1)
    ]
    assert penalties == pytest.approx([0.8, 0.8, 1.0 / 1.25])


def test_slowness_against_the_traffic_around() -> None:
    fast = SyntheticActor(motion=Motion.steady(-20.0, 3.5, steps=STEPS, speed=2.0 * SPEED))
    values = measured(driver(), others=[fast])
    assert values["efficiency"] == pytest.approx(50.0, rel=1e-3)
    assert values["driving_score_1_0"] == 100.0
    # Four sections of the route, each at half the speed of the traffic.
    assert values["driving_score_2_0"] == pytest.approx(100.0 * (1.0 - 0.3 * 0.5) ** 4)
    assert values["driving_score"] == pytest.approx(100.0 / (1.0 + 4 * 0.4 * 0.5))


def test_being_faster_than_the_traffic_is_efficient_but_earns_nothing() -> None:
    slow = SyntheticActor(motion=Motion.steady(20.0, 3.5, steps=STEPS, speed=0.5 * SPEED))
    values = measured(driver(), others=[slow])
    assert values["efficiency"] == pytest.approx(200.0, rel=1e-3)
    assert values["driving_score"] == 100.0


def test_standing_traffic_tells_nothing_about_pace() -> None:
    parked = SyntheticActor(motion=Motion.steady(20.0, 3.5, steps=STEPS))
    assert measured(driver(), others=[parked])["efficiency"] is None


def test_distance_outside_the_lanes_is_taken_off() -> None:
    outside = np.arange(STEPS) >= 100
    motion = Motion.along(0.4 * np.arange(STEPS), np.where(outside, -4.0, 0.0), yaw=0.0)
    ego = driver(
        motion=motion,
        lane=np.where(outside, -1, EAST),
        lane_lateral=np.where(outside, np.nan, 0.0),
        route_s=0.4 * np.arange(STEPS),
    )
    values = measured(ego)
    way, driven = 139 * 0.4 + np.hypot(0.4, 4.0), 238 * 0.4 + np.hypot(0.4, 4.0)
    assert values["infraction_penalty"] == pytest.approx(1.0 - way / driven)
    assert values["driving_score_1_0"] == pytest.approx(100.0 * (1.0 - way / driven))


def test_a_stationary_ego_that_is_hit_is_charged_nothing() -> None:
    waiting = driver(motion=Motion.steady(0.0, 0.0, steps=STEPS), end=TerminalEvent.COLLISION)
    rammer = SyntheticActor(motion=Motion.steady(-40.0, 0.0, steps=STEPS, speed=SPEED))
    values = measured(waiting, others=[rammer], contacts=[CRASH])
    assert values["infraction_penalty"] == 1.0  # it never left the first section of its route
    assert values["driving_score_1_0"] == 0.0
    assert values["nuplan_no_at_fault_collision"] == 1.0


def test_nuplan_halves_for_one_object_and_ends_for_more() -> None:
    one = measured(driver(), others=[standing(Role.NPC_OBSTACLE)], contacts=[CRASH])
    assert one["nuplan_no_at_fault_collision"] == 0.5
    two = [standing(Role.NPC_OBSTACLE), standing(Role.NPC_OBSTACLE, 60.0)]
    both = measured(driver(), others=two, contacts=[CRASH, Contact(step=140, ego=0, other=2)])
    assert both["nuplan_no_at_fault_collision"] == 0.0
    walker = measured(driver(), others=[standing(Role.NPC_WALKER)], contacts=[CRASH])
    assert walker["nuplan_no_at_fault_collision"] == 0.0


def test_nuplan_speed_score_falls_with_the_mean_overspeed() -> None:
    values = measured(driver(speed_limit=SPEED - 1.0))
    assert values["nuplan_speed_limit"] == pytest.approx(1.0 - 1.0 / 2.23)


def test_route_completion_of_an_ego_that_did_not_arrive() -> None:
    ego = driver(
        route=np.array([(0.0, 0.0), (200.0, 0.0)]), end=TerminalEvent.COLLISION, end_step=100
    )
    values = measured(ego)
    assert values["route_completion"] == pytest.approx(100.0 * 40.0 / 200.0)
    assert values["success"] == 0.0


def test_nothing_is_completed_beyond_a_deviation() -> None:
    off = np.where(np.arange(STEPS) >= 50, 31.0, 0.0)
    route = np.array([(0.0, 0.0), (200.0, 0.0)])
    values = measured(driver(route_lateral=off, route=route, end=TerminalEvent.TIME_LIMIT))
    assert values["route_completion"] == pytest.approx(100.0 * 20.0 / 200.0)


def test_the_scores_of_several_egos() -> None:
    lagging = driver(
        id="lagging",
        motion=Motion.steady(0.0, 3.5, steps=STEPS, speed=0.5 * SPEED),
        lane_lateral=0.0,
        end=TerminalEvent.TIME_LIMIT,
    )
    values = measured(driver(id="leading"), lagging)
    assert values["route_completion[leading]"] == 100.0
    part = values["route_completion[lagging]"]
    assert part is not None
    assert part == pytest.approx(100.0 * 0.2 * 239 / 90.0)
    assert values["route_completion"] == pytest.approx((100.0 + part) / 2.0)
    assert values["success"] == 0.0
    assert values["success[leading]"] == 1.0
    assert values["min_gap_m"] == values["min_gap_m[leading]"] == pytest.approx(3.5 - 1.8)


def test_an_ego_that_never_started_completed_nothing() -> None:
    values = measured(driver(start_time=100.0))
    assert values["driving_score"] == 0.0
    assert values["success"] is None
    assert values["comfort"] is None


def test_nothing_to_judge_scores_as_passed() -> None:
    found = 0
    for trace in example_runs():
        verdicts = judge_all(trace, ROAD, default_oracles())
        found += sum(verdict.outcome is Outcome.NOT_APPLICABLE for verdict in verdicts)
        passed = [
            replace(verdict, outcome=Outcome.PASSED)
            if verdict.outcome is Outcome.NOT_APPLICABLE
            else verdict
            for verdict in verdicts
        ]
        assert measure(trace, ROAD, verdicts) == measure(trace, ROAD, passed)
    assert found > 0


def test_the_drivable_area_of_nuplan_excuses_no_short_excess() -> None:
    lateral = np.where(np.arange(STEPS) == 20, -1.2, 0.0)
    motion = Motion.along(0.5 * np.arange(STEPS), lateral, yaw=0.0)
    trace = make_trace([driver(motion=motion, lane_lateral=lateral)])
    verdicts = judge_all(trace, ROAD, default_oracles())
    assert "off_road" not in {v.oracle for v in verdicts if v.outcome is Outcome.VIOLATED}
    assert measure(trace, ROAD, verdicts)["nuplan_drivable_area"] == 0.0


def test_without_verdicts_nothing_is_made_up() -> None:
    trace = make_trace([driver()])
    values = measure(trace, ROAD, ())
    for name in ("driving_score", "success", "nuplan_drivable_area", "nuplan_comfort"):
        assert values[name] is None


def test_a_conflict_that_came_to_nothing() -> None:
    # Another that is closed in upon from 30 m and drives off in time.
    x = 34.5 + np.where(np.arange(STEPS) < 40, 0.0, 0.6 * (np.arange(STEPS) - 40))
    lead = SyntheticActor(motion=Motion.along(x, 0.0, yaw=0.0))
    values = measured(driver(), others=[lead])
    gap = values["min_gap_m"]
    assert gap is not None
    assert gap == pytest.approx(30.0 - 40 * 0.4, abs=0.5)
    assert values["min_time_to_collision_s"] == pytest.approx(gap / SPEED, abs=0.1)
    assert values["max_drac_mps2"] == pytest.approx(SPEED**2 / (2.0 * 14.4), rel=0.05)
    assert values["nuplan_time_to_collision"] == 1.0
    assert 0.0 < (values["rss_violation_share"] or 0.0) < 1.0
    assert values["post_encroachment_time_s"] is None


@pytest.mark.parametrize("trace", example_runs())
def test_every_value_is_a_finite_number_or_none(trace: Trace) -> None:
    json.dumps(_measure(trace), allow_nan=False)


def test_names_do_not_depend_on_what_happened() -> None:
    single = [trace for trace in example_runs() if trace.ego_count == 1]
    assert len({tuple(_measure(trace)) for trace in single}) == 1


def test_a_shared_view_changes_nothing() -> None:
    trace = make_trace([driver()], [standing(Role.NPC_VEHICLE, 200.0)])
    view = RunView(trace, ROAD)
    verdicts = judge_all(trace, ROAD, default_oracles(), view=view)
    assert measure(trace, ROAD, verdicts, view=view) == _measure(trace)


def test_the_reference_names_every_metric(repository: Path) -> None:
    text = (repository / "docs" / "reference" / "oracles.md").read_text(encoding="utf-8")
    section = text.split("## Metrics")[1].split("The penalty of")[0]
    rows = [line.split("|")[1] for line in section.splitlines() if line.startswith("| `")]
    documented = {name for row in rows for name in re.findall(r"`(\w+)`", row)}
    assert documented == set(measured(driver()))
