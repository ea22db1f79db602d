"""LawBreaker's feedback: how far each way to violate a law is from happening."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.errors import SearchError
from drivora_service.feedback.catalogue import FeedbackCatalogue
from drivora_service.feedback.lawbreaker import LawbreakerFeedback, law_of, objectives_of
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.observations.run_view import RunView
from drivora_service.oracles.laws.law_judging import LawOracle
from drivora_service.oracles.verdict import Outcome
from drivora_service.testing.oracle_contract import example_runs
from drivora_service.testing.traces import Motion, SyntheticEgo, make_trace
from tests.oracles.judging import ROAD, on_lane
from tests.oracles.laws.laws import law_of as law_with
from tests.oracles.laws.laws import library, shipped


def at_speed(speed: float, name: str = "ego", y: float = 0.0) -> SyntheticEgo:
    return on_lane(id=name, motion=Motion.steady(0.0, y, steps=60, speed=speed))


def measured(*egos: SyntheticEgo) -> dict[str, float | None]:
    feedback = LawbreakerFeedback(laws=(law_with("speed <= 6 and speed_limit > 2"),))
    return dict(feedback.measure(RunView(make_trace(egos), ROAD)).objectives)


def test_the_way_that_is_nearest_is_below_the_others() -> None:
    values = measured(at_speed(5.0))
    # Only too fast; only a low limit; both.
    assert values == pytest.approx({"own_law/1": 0.1, "own_law/2": 0.8, "own_law/3": 0.8})


def test_a_violation_is_below_zero() -> None:
    assert measured(at_speed(8.0))["own_law/1"] == pytest.approx(-0.2)


def test_of_several_egos_the_worst_counts() -> None:
    both = measured(at_speed(5.0, "one"), at_speed(8.0, "other", 3.5))
    assert both["own_law/1"] == pytest.approx(-0.2)


def test_an_ego_that_has_not_started_is_left_out() -> None:
    waits = on_lane(id="w", motion=Motion.steady(0.0, 3.5, steps=60, speed=9.0), start_time=60.0)
    assert measured(at_speed(5.0), waits)["own_law/1"] == pytest.approx(0.1)
    assert set(measured(waits).values()) == {None}


def test_names_tell_the_law() -> None:
    laws = [library().law(name) for name in library().names()]
    names = objectives_of(laws)
    assert len(set(names)) == len(names)
    assert {law_of(name) for name in names} == set(library().names())
    assert "law_52_priority/3" in names


def test_it_is_below_zero_where_the_verdict_shows_the_way() -> None:
    """The verdicts of the laws, and so the coverage of campaigns, say the same."""
    for name in library().names():
        law, oracle = library().law(name), shipped(name)
        for trace in example_runs():
            view = RunView(trace, ROAD)
            found = LawbreakerFeedback(laws=(law,)).measure(view).objectives
            shown = {
                way
                for verdict in oracle.judge(view)
                if verdict.outcome is Outcome.VIOLATED
                for way in verdict.evidence["sub_violations"]
            }
            for case, cost in zip(law.sub_violations, found.values(), strict=True):
                assert (str(case) in shown) == (cost is not None and cost < 0.0)


def test_the_catalogue_has_it_with_the_laws_of_the_installation() -> None:
    own = law_with("speed <= 6")
    chosen = FeedbackChoice(name="lawbreaker")
    assert FeedbackCatalogue([own]).create(chosen).objectives == ("own_law/1",)
    shipped_names = objectives_of([library().law(name) for name in library().names()])
    assert FeedbackCatalogue().create(chosen).objectives == shipped_names
    with pytest.raises(SearchError, match="no_such"):
        FeedbackCatalogue().create(FeedbackChoice(name="lawbreaker", parameters={"no_such": 1}))


def test_oracle_and_feedback_agree_on_a_random_drive() -> None:
    random = np.random.default_rng(1)
    law = law_with("speed <= 6 -> eventually[0:0.5] (speed > 4)")
    for _ in range(20):
        speeds = np.repeat(random.uniform(0.0, 9.0, 12), 5)
        motion = Motion.along(np.cumsum(speeds) * 0.05, 0.0, yaw=0.0)
        motion.states[:, 3] = speeds
        view = RunView(make_trace([on_lane(motion=motion)]), ROAD)
        broken = LawOracle(law=law).judge(view)[0].outcome is Outcome.VIOLATED
        (cost,) = LawbreakerFeedback(laws=(law,)).measure(view).objectives.values()
        assert cost is not None
        assert broken == (cost < 0.0)
