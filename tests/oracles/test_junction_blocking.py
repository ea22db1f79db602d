"""Egos that stand in a junction: with a reason, without one, and with others waiting for them.

The junction is the one of Harbour Street with Mill Street in tee-town: Harbour Street leads east
and west with priority, Mill Street joins it from the north, all without signals.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from shapely import LineString

from drivora_service.agents.interface import AccelerationControl, Control, Observation
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Contact, Role, Trace
from drivora_service.oracles.junction_blocking import JunctionBlocking
from drivora_service.oracles.junction_stands.stands import find_junction_stands
from drivora_service.oracles.verdict import Outcome, Severity, Verdict
from drivora_service.scenario.conversion import to_scenario
from drivora_service.scenario.documents import read_document
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace
from tests.oracles.streets import DT, along, on_network, way
from tests.simulation.episodes import Scripted, car, ego, network, place, run, scenario

TOWN = network("tee-town")
GRID = network("signal-grid")
EAST = way(TOWN, "harbour_0_0", "harbour_1_0")
WEST = way(TOWN, "-harbour_1_0", "-harbour_0_0")
LEFT = way(TOWN, "harbour_0_0", "mill_1_0")
FROM_MILL = way(TOWN, "-mill_1_0", "harbour_1_0")
LINE = float(TOWN.lane("harbour_0_0").arc[-1])
INSIDE = 18.5
"""Metres of the way straight on through the junction."""
SECONDS = 40.0
TIMES = np.arange(round(SECONDS / DT)) * DT


def arrives(stop: float, speed: float = 8.0, line: float = LINE) -> np.ndarray:
    """Metres of a front that comes to a stop ``stop`` metres behind a line, 4 s after the start."""
    fronts: np.ndarray = np.minimum(line + stop + speed * (TIMES - 4.0), line + stop)
    return fronts


def judge(
    driver: SyntheticEgo, *others: SyntheticActor, contacts: tuple[Contact, ...] = ()
) -> Verdict:
    view = RunView(make_trace([driver], others, step_length=DT, contacts=contacts), TOWN)
    (verdict,) = JunctionBlocking().judge(view)
    return verdict


def standing(stop: float = 12.0, line: np.ndarray = EAST, **fields: Any) -> SyntheticEgo:
    """An ego that stands ``stop`` metres behind the stop line from 4 s on."""
    return on_network(TOWN, along(line, arrives(stop)), route=line, **fields)


def stays(line: np.ndarray, front: float, name: str = "npc", **fields: Any) -> SyntheticActor:
    return SyntheticActor(motion=along(line, np.full(len(TIMES), front)), id=name, **fields)


def moves(line: np.ndarray, fronts: np.ndarray, name: str = "npc", **fields: Any) -> SyntheticActor:
    return SyntheticActor(motion=along(line, fronts), id=name, **fields)


def oncoming(every: float, until: float = SECONDS) -> list[SyntheticActor]:
    """Vehicles on Harbour Street that come through at 10 m/s, one after the other."""
    line = float(TOWN.lane("-harbour_1_0").arc[-1])
    found = []
    for k, passes in enumerate(np.arange(2.0, until, every)):
        fronts = line + 10.0 * (TIMES - passes)
        there = (fronts > 6.0) & (fronts < line + 60.0)
        found.append(moves(WEST, np.clip(fronts, 6.0, line + 60.0), f"w{k}", present=there))
    return found


class TestWithoutReason:
    def test_a_free_way(self) -> None:
        verdict = judge(standing())
        assert verdict.outcome is Outcome.VIOLATED
        assert verdict.at_fault is True
        assert verdict.severity is Severity.MINOR
        assert verdict.time == pytest.approx(14.0, abs=0.2)
        assert verdict.evidence["since"] == pytest.approx(4.0, abs=0.2)
        assert verdict.evidence["duration"] == pytest.approx(36.0, abs=0.2)
        assert verdict.evidence["junction"] == "harbour_mill"
        assert verdict.evidence["waiting"] == []

    @pytest.mark.parametrize(("seconds", "broken"), [(9.8, False), (10.4, True)])
    def test_the_bound(self, seconds: float, broken: bool) -> None:
        fronts = arrives(12.0)
        fronts = fronts + 8.0 * np.maximum(TIMES - 4.0 - seconds, 0.0)
        motion = along(EAST, np.minimum(fronts, LINE + 80.0))
        verdict = judge(on_network(TOWN, motion, route=EAST))
        assert (verdict.outcome is Outcome.VIOLATED) is broken

    def test_a_jerk_forward_clears_nothing(self) -> None:
        fronts = arrives(11.0) + np.clip(2.0 * (TIMES - 12.0), 0.0, 0.6)
        fronts += 8.0 * np.maximum(TIMES - 18.0, 0.0)
        motion = along(EAST, np.minimum(fronts, LINE + 80.0))
        assert judge(on_network(TOWN, motion, route=EAST)).outcome is Outcome.VIOLATED

    @pytest.mark.parametrize(
        ("line", "stop", "outcome"),
        [(EAST, -0.5, Outcome.NOT_APPLICABLE), (EAST, INSIDE + 12.0, Outcome.PASSED)],
        ids=["before the line", "behind the junction"],
    )
    def test_outside_the_junction(self, line: np.ndarray, stop: float, outcome: Outcome) -> None:
        assert judge(standing(stop, line)).outcome is outcome

    def test_where_no_way_of_others_leads(self) -> None:
        """Right behind the line of Harbour Street, where only the ego's own ways lead."""
        assert judge(standing(3.0)).outcome is Outcome.PASSED

    def test_cut_short(self) -> None:
        fronts = np.minimum(LINE + 12.0 + 8.0 * (TIMES - 35.0), LINE + 12.0)
        verdict = judge(on_network(TOWN, along(EAST, np.maximum(fronts, 6.0)), route=EAST))
        assert verdict.outcome is Outcome.NOT_MEASURABLE
        assert verdict.evidence["duration"] == pytest.approx(5.0, abs=0.2)

    def test_an_accident_is_a_reason(self) -> None:
        touched = Contact(step=round(5.0 / DT), ego=0, other=1)
        assert judge(standing(), stays(WEST, 8.0), contacts=(touched,)).outcome is Outcome.PASSED


class TestWaitingVehicles:
    def test_one_that_would_cross(self) -> None:
        mill = float(TOWN.lane("-mill_1_0").arc[-1])
        verdict = judge(standing(), stays(FROM_MILL, mill - 1.0, "crossing"))
        assert verdict.severity is Severity.MAJOR
        assert verdict.counterpart == "crossing"
        assert verdict.evidence["waiting"] == ["crossing"]
        assert verdict.evidence["longest_wait"] == pytest.approx(36.0, abs=1.0)

    def test_one_behind(self) -> None:
        fronts = np.minimum(LINE - 30.0 + 8.0 * (TIMES - 20.0), LINE + 5.0)
        verdict = judge(standing(), moves(EAST, np.maximum(fronts, 8.0), "behind"))
        assert verdict.severity is Severity.MAJOR
        assert verdict.evidence["waiting"] == ["behind"]
        assert verdict.evidence["longest_wait"] == pytest.approx(15.6, abs=1.0)

    @pytest.mark.parametrize(
        "other",
        [
            stays(EAST, LINE + INSIDE + 60.0),
            stays(WEST, 60.0),
            stays(FROM_MILL, float(TOWN.lane("-mill_1_0").arc[-1]) - 40.0),
        ],
        ids=["ahead", "oncoming", "far"],
    )
    def test_others_do_not_wait_for_it(self, other: SyntheticActor) -> None:
        verdict = judge(standing(), other)
        assert verdict.severity is Severity.MINOR
        assert verdict.evidence["waiting"] == []


class TestGivingWay:
    """The ego turns left into Mill Street and stands in front of the oncoming lane."""

    stop = 10.0

    def test_it_stands_where_others_drive(self) -> None:
        view = RunView(make_trace([standing(self.stop, LEFT)], step_length=DT), TOWN)
        (stand,) = find_junction_stands(view.egos[0], standing_speed=0.1)
        assert stand.movement is not None
        assert stand.movement.yields_to

    def test_for_a_flow_without_a_gap(self) -> None:
        verdict = judge(standing(self.stop, LEFT), *oncoming(5.0, until=SECONDS + 10.0))
        assert verdict.outcome is Outcome.PASSED

    def test_for_none(self) -> None:
        assert judge(standing(self.stop, LEFT)).outcome is Outcome.VIOLATED

    def test_once_it_has_passed(self) -> None:
        verdict = judge(standing(self.stop, LEFT), *oncoming(5.0, until=18.0))
        assert verdict.outcome is Outcome.VIOLATED
        assert 17.0 < verdict.evidence["since"] < 20.0

    def test_gaps_that_it_lets_pass_add_up(self) -> None:
        verdict = judge(standing(self.stop, LEFT), *oncoming(16.0))
        assert verdict.outcome is Outcome.VIOLATED
        assert verdict.evidence["duration"] < 25.0

    def test_not_on_the_way_with_priority(self) -> None:
        assert judge(standing(), *oncoming(5.0)).outcome is Outcome.VIOLATED

    def test_for_a_walker_on_its_way(self) -> None:
        x, y = np.asarray(LineString(LEFT).interpolate(LINE + 14.0).coords[0])
        walker = SyntheticActor(
            motion=Motion.steady(float(x), float(y), steps=len(TIMES)),
            role=Role.NPC_WALKER,
            length=0.5,
            width=0.5,
        )
        assert judge(standing(self.stop, LEFT), walker).outcome is Outcome.PASSED


class TestBlockedExit:
    """A vehicle ahead leaves no room behind the junction."""

    full = LINE + INSIDE + 4.5 + 2.0
    """Front of a vehicle with its tail two metres behind the junction."""

    def test_one_that_stood_there_before(self) -> None:
        verdict = judge(standing(), stays(EAST, self.full))
        assert verdict.outcome is Outcome.VIOLATED
        assert verdict.evidence["entered_without_room"] is True
        assert "without room" in verdict.message

    def test_one_with_room_before_it(self) -> None:
        verdict = judge(standing(), stays(EAST, self.full + 6.0))
        assert verdict.outcome is Outcome.VIOLATED
        assert verdict.evidence["entered_without_room"] is False

    def test_one_that_stops_after_the_ego_has_entered(self) -> None:
        ahead = np.minimum(self.full + 8.0 * (TIMES - 3.6), self.full)
        assert judge(standing(), moves(EAST, ahead)).outcome is Outcome.PASSED

    def test_a_queue_that_the_vehicle_between_joins(self) -> None:
        """The room is enough for one, and the vehicle ahead of the ego takes it."""
        ahead = np.minimum(self.full + 8.0 * (TIMES - 3.6), self.full)
        queue = stays(EAST, self.full + 4.5 + 2.0, "queue")
        verdict = judge(standing(), moves(EAST, ahead), queue)
        assert verdict.outcome is Outcome.VIOLATED
        assert verdict.evidence["entered_without_room"] is True

    def test_once_it_has_gone(self) -> None:
        ahead = np.minimum(self.full + 8.0 * (TIMES - 3.6), self.full)
        ahead += 8.0 * np.maximum(TIMES - 20.0, 0.0)
        verdict = judge(standing(), moves(EAST, np.minimum(ahead, self.full + 80.0)))
        assert verdict.outcome is Outcome.VIOLATED
        assert verdict.evidence["since"] == pytest.approx(20.6, abs=0.5)


class TestSignals:
    """A left turn on permissive green, at a junction of signal-grid with oncoming traffic."""

    def test_oncoming_traffic_on_red_is_no_reason(self) -> None:
        assert self._judge("G").outcome is Outcome.PASSED
        assert self._judge("r").outcome is Outcome.VIOLATED

    def _judge(self, shown: str) -> Verdict:
        line = way(GRID, "-bridge_2_2", _lane_behind("-bridge_2_2", "l"))
        opposite = way(GRID, "bridge_1_1", _lane_behind("bridge_1_1", "s"))
        end = float(GRID.lane("-bridge_2_2").arc[-1])
        driver = on_network(GRID, along(line, arrives(9.0, line=end)), route=line)
        # On its way to the line for as long as the run takes.
        fronts = float(GRID.lane("bridge_1_1").arc[-1]) - 2.0 - 1.0 * (SECONDS - TIMES)
        lights = {"c2": [shown * 80] * len(TIMES)}
        trace = make_trace([driver], [moves(opposite, fronts)], step_length=DT, lights=lights)
        (verdict,) = JunctionBlocking(headway=60.0).judge(RunView(trace, GRID))
        return verdict


def _lane_behind(before: str, direction: str) -> str:
    """The lane that a movement from a lane leads to."""
    connections = GRID.lane(before).connections
    lane = GRID.lanes[next(c.to_lane for c in connections if c.direction == direction)]
    while lane.is_internal:
        lane = GRID.lanes[lane.connections[0].to_lane]
    return lane.id


class Stopping:
    """Makes an agent that drives at 8 m/s and stands from a place on its route on."""

    @staticmethod
    def at(s: float) -> Scripted:
        def answer(seen: Observation) -> Control:
            room = s - seen.route_s
            wanted = min(8.0, np.sqrt(max(2.0 * 2.0 * (room - 0.5), 0.0)))
            return AccelerationControl(float(np.clip(2.0 * (wanted - seen.speed), -8.0, 2.0)), 0.0)

        return Scripted(answer)


@pytest.mark.parametrize("behind", [False, True])
def test_an_ego_that_stands_in_a_junction_in_a_simulation(behind: bool) -> None:
    start = place("harbour_0_0", LINE - 40.0)
    others = [car(place("harbour_0_0", LINE - 60.0), place("harbour_1_0", 40.0))] if behind else []
    what = scenario(
        ego(start, place("harbour_1_0", 40.0)), npc_vehicles=tuple(others), seconds=40.0
    )
    verdict = _blocking(run(what, Stopping.at(40.0 + 9.0)))
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.at_fault is True
    assert verdict.severity is (Severity.MAJOR if behind else Severity.MINOR)


@pytest.fixture(scope="session")
def shared_verdicts() -> Path:
    """Cases with known verdicts that lie beside the checkout; skipped where they are absent."""
    path = Path(__file__).resolve().parents[3] / "shared" / "cases" / "verdicts"
    if not path.is_dir():
        pytest.skip("the cases with known verdicts are not beside the checkout")
    return path


@pytest.mark.parametrize("name", ["standing-in-junction", "standing-in-junction-with-traffic"])
def test_cases_of_others(name: str, shared_verdicts: Path) -> None:
    document = read_document((shared_verdicts / f"{name}.json").read_text()).document
    assert document is not None
    verdict = _blocking(run(to_scenario(document, TOWN)))
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.at_fault is True
    assert verdict.evidence["waiting"] == ["n"]


def _blocking(trace: Trace) -> Verdict:
    (verdict,) = JunctionBlocking().judge(RunView(trace, TOWN))
    return verdict
