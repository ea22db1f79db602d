"""A breach of the ego that led to a collision excludes the excuse that there was no time left.

The collisions are cases of responsibility; their second reader named the breach as well.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from drivora_service.observations.run_view import RunView
from drivora_service.oracles.collision import Collision
from drivora_service.oracles.verdict import Answer, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability, accountability
from drivora_service.scenario.documents import parse_document
from tests.conftest import ROOT
from tests.oracles.responsibility.case import AT_FAULT, Case, Ego, Parked
from tests.oracles.responsibility.judged import collisions, record
from tests.oracles.responsibility.ways import Drive, straight, town

CHAINS = {
    "ego-follows-at-four-metres-and-leader-slows-down": "tailgating",
    "ego-follows-at-five-metres-on-the-highway": "tailgating",
    "ego-follows-close-and-leader-stops-for-walker": "tailgating",
    "ego-turns-right-before-vehicle-and-is-hit-from-behind": "failure_to_yield",
    "ego-enters-great-ring-before-circulating-vehicle": "failure_to_yield",
    "ego-crosses-priority-road-in-town": "failure_to_yield",
    "ego-turns-left-before-oncoming": "failure_to_yield",
    "ego-too-fast-in-alley-and-walker-crosses": "speeding",
    "ego-cuts-in-on-the-highway-and-brakes": "manoeuvre",
    "ego-merged-just-now-and-is-hit": "manoeuvre",
    "ego-drifts-over-at-pocket-border": "manoeuvre",
    "ego-rolls-into-junction-on-new-green-and-hits-vehicle-that-clears": "red_light",
}
NO_BREACH = (
    "ego-had-followed-close-and-has-dropped-back",
    "ego-drove-too-fast-seven-seconds-ago-and-is-hit",
    "other-cuts-in-short",
    "motorcycle-hits-creeping-ego",
)
SHARED = {"right-turn-before-van": "failure_to_yield", "tailgater-leader-brakes": "tailgating"}


@pytest.mark.parametrize("name", CHAINS)
def test_the_breach_is_named_and_the_collision_counts(name: str) -> None:
    verdict = collisions(name)["ego"]
    evidence = verdict.evidence["avoidability"]
    assert evidence["own_breach"] == CHAINS[name]
    assert evidence["own_breach_before"] > 0.0
    assert "the ego" in evidence["chain"]
    assert evidence["chain"][1:] in verdict.message
    assert verdict.avoidable is Answer.YES
    assert accountability(verdict) is Accountability.AVOIDABLE


@pytest.mark.parametrize("name", NO_BREACH)
def test_a_breach_that_led_to_nothing_is_none(name: str) -> None:
    evidence = collisions(name)["ego"].evidence["avoidability"]
    assert evidence["own_breach"] is None
    assert evidence["chain"] is None


@pytest.mark.parametrize("name", SHARED)
def test_collisions_that_were_excused_before(name: str) -> None:
    path: Path = ROOT.parent / "shared" / "cases" / "verdicts" / f"{name}.json"
    if not path.is_file():
        pytest.skip("the shared cases are not here")
    document = parse_document(json.loads(path.read_text()))
    view = RunView(record(document), town(document.map_region.town))
    (verdict,) = Collision().judge(view)
    assert verdict.at_fault
    assert verdict.evidence["avoidability"]["own_breach"] == SHARED[name]
    assert accountability(verdict) is Accountability.AVOIDABLE


def set_off(*, gap: float, appears: float = 0.0) -> Verdict:
    """The verdict on an ego that stands for 3 s and then sets off into a vehicle that stands."""
    y = -7.75
    ego = Drive(way=straight((970.0, y), (1029.0, y)), speeds=((0.0, 0.0), (3.0, 0.0), (6.0, 6.0)))
    case = Case(
        name="ego-sets-off-into-what-stands",
        happens="The ego stands, sets off, and hits the vehicle that stands before it.",
        expected=AT_FAULT,
        source="UN R157: a careful driver does not set off towards what stands in the way",
        town="arterial",
        egos=(Ego(drive=ego, to=(1029.0, y)),),
        others=(Parked(at=(970.0 + 4.8 + gap, y), start_time=appears),),
    )
    document = case.document()
    (verdict,) = Collision().judge(RunView(record(document), town(case.town)))
    return verdict


def test_an_ego_that_sets_off_into_what_stands_in_its_way() -> None:
    verdict = set_off(gap=3.0)
    evidence = verdict.evidence["avoidability"]
    assert verdict.at_fault
    # There was no time left from the first motion on, but it need not have moved.
    assert evidence["latest_before"] > evidence["risk_perceived_before"]
    assert evidence["own_breach"] == "setting_off"
    assert accountability(verdict) is Accountability.AVOIDABLE


@pytest.mark.parametrize("where", [{"gap": 3.0, "appears": 3.5}, {"gap": 25.0}])
def test_an_ego_that_set_off_before_there_was_a_danger(where: dict[str, float]) -> None:
    assert set_off(**where).evidence["avoidability"]["own_breach"] != "setting_off"
