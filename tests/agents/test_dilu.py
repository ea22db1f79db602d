"""DiLu's parts: from a situation to a prompt, to a decision, to what is learnt, to a control."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.agents.adapters.dilu.adapter import examples_in
from drivora_service.agents.adapters.dilu.decisions import DECISIONS, Decision, decision_in
from drivora_service.agents.adapters.dilu.driving import idm_acceleration
from drivora_service.agents.adapters.dilu.experiences import (
    Experience,
    Memory,
    read_experiences,
)
from drivora_service.agents.adapters.dilu.models import ModelError
from drivora_service.agents.adapters.dilu.operator_settings import (
    EndpointSettings,
    read_endpoint_settings,
)
from drivora_service.agents.adapters.dilu.prompts import (
    check_messages,
    decision_messages,
    example_answer,
    reflection_messages,
)
from drivora_service.agents.adapters.dilu.situation import (
    Beside,
    Neighbour,
    Situation,
    available,
    describe_situation,
    features,
    in_brief,
)

FREE = Situation(speed=5.0, wanted=5.0, allowed=13.9)
BUSY = Situation(
    speed=10.0,
    wanted=12.0,
    allowed=13.9,
    ahead=Neighbour(gap=18.4, speed=4.0),
    left=Beside(behind=Neighbour(gap=3.0, speed=14.0)),
    right=Beside(),
    stop=60.0,
    crossing=25.0,
)

gaps = st.none() | st.builds(Neighbour, gap=st.floats(0.0, 200.0), speed=st.floats(-5.0, 40.0))
lanes = st.none() | st.builds(Beside, ahead=gaps, behind=gaps)
distances = st.none() | st.floats(0.0, 500.0)
situations = st.builds(
    Situation,
    speed=st.floats(0.0, 40.0),
    wanted=st.floats(0.0, 40.0),
    allowed=st.floats(0.5, 40.0),
    ahead=gaps,
    left=lanes,
    right=lanes,
    stop=distances,
    crossing=distances,
)


def test_a_situation_is_told_at_length_and_in_brief() -> None:
    assert describe_situation(BUSY) == (
        "You drive at 10.0 m/s and want 12.0 m/s; allowed are 13.9 m/s. Ahead in your lane: 18 m "
        "away, at 4.0 m/s (slower). Lane to the left: ahead nobody, behind 3 m away, at 14.0 m/s "
        "(faster). Lane to the right: ahead nobody, behind nobody. You must stop at a light in "
        "60 m. Somebody will cross in 25 m."
    )
    assert in_brief(BUSY) == (
        "Speed right. Slower car 18 m ahead. Left blocked. Right free. Red light 60 m. Car crosses "
        "25 m."
    )
    assert in_brief(replace(FREE, speed=0.0)) == (
        "Standing. Too slow. Road free. No left. No right."
    )


@pytest.mark.parametrize(
    ("answer", "decision"),
    [
        ("The road is free.\nResponse to user:#### accelerate", Decision.ACCELERATE),
        ("#### left is wrong, #### Keep.", Decision.KEEP),
        ("I keep going left? No.\n#### <decelerate>", Decision.DECELERATE),
        ("right", Decision.RIGHT),
        ("I would rather decelerate", Decision.DECELERATE),
        ("#### left or right", None),
        ("#### 3", None),
        ("#### accelerated", None),
        ("keep #### ", None),
        ("", None),
    ],
)
def test_the_decision_behind_the_last_delimiter_counts(
    answer: str, decision: Decision | None
) -> None:
    assert decision_in(answer) is decision


@given(st.sampled_from(DECISIONS), st.booleans(), st.text(max_size=40))
def test_what_examples_show_is_what_is_read(decision: Decision, reasons: bool, why: str) -> None:
    assert decision_in(example_answer(decision, why, reasons)) is decision


def test_examples_stand_before_the_question() -> None:
    known = Experience(situation=FREE, decision=Decision.ACCELERATE, why="It is free.")
    aloud = decision_messages([known], BUSY, reasons=True)
    assert [m.role for m in aloud] == ["system", "user", "assistant", "user"]
    assert aloud[1].content == describe_situation(FREE)
    assert aloud[2].content == "It is free.\nResponse to user:#### accelerate"
    assert aloud[3].content == (
        f"{describe_situation(BUSY)} Available now: left, keep, right, accelerate, decelerate."
    )
    at_once = decision_messages([known], BUSY, reasons=False)
    assert [m.content for m in at_once[1:]] == [in_brief(FREE), "accelerate", in_brief(BUSY)]
    assert all(word in at_once[0].content and word in aloud[0].content for word in DECISIONS)


def test_a_check_and_a_reflection_tell_what_was_said() -> None:
    (check,) = check_messages("perhaps faster")
    assert "perhaps faster" in check.content
    reflection = reflection_messages(BUSY, Decision.KEEP, "#### keep", reasons=True)
    assert [m.role for m in reflection] == ["system", "user", "assistant", "user"]
    assert (reflection[1].content, reflection[2].content) == (describe_situation(BUSY), "#### keep")
    assert "keep was wrong" in reflection[3].content


def test_the_shipped_experiences_are_of_every_kind_and_sensible() -> None:
    shipped = read_experiences()
    assert {known.decision for known in shipped} == set(Decision)
    for known in shipped:
        assert known.why.endswith(".")
        assert known.decision in available(known.situation), known


def test_the_memory_gives_what_is_most_like_and_keeps_what_is_new() -> None:
    shipped = read_experiences()
    memory = Memory(shipped)
    for number, known in enumerate(shipped, start=1):
        first = memory.recall(known.situation, 1)[0]
        assert first.distance == 0.0
        assert first.experience.decision is known.decision, (number, first)
        assert not memory.is_new(known.situation)
    assert memory.is_new(BUSY)
    assert memory.add(Experience(situation=BUSY, decision=Decision.KEEP, why="x")) == 27
    assert memory.recall(BUSY, 2)[0].number == 27
    assert memory.recall(BUSY, 0) == []
    # What a run has learnt is not there in the next.
    assert len(Memory(shipped).experiences) == 26


@given(situations)
def test_every_situation_can_be_told_and_compared(situation: Situation) -> None:
    assert np.isfinite(features(situation)).all()
    assert describe_situation(situation)
    assert in_brief(situation)


@given(st.floats(0.0, 40.0), st.floats(0.0, 40.0), st.floats(0.0, 200.0), st.floats(0.0, 40.0))
def test_who_is_ahead_only_ever_makes_it_slower(
    speed: float, wanted: float, gap: float, lead: float
) -> None:
    free = idm_acceleration(speed, wanted, standstill=2.0)
    behind = idm_acceleration(speed, wanted, gap=gap, lead=lead, standstill=2.0)
    assert behind <= free <= 1.5
    assert math.isfinite(behind)


def test_it_rests_where_it_should() -> None:
    assert idm_acceleration(12.0, 12.0, standstill=2.0) == pytest.approx(0.0)
    assert idm_acceleration(0.0, 12.0, gap=2.0, standstill=2.0) == pytest.approx(0.0)
    assert idm_acceleration(0.0, 0.0, standstill=2.0) < 0.0
    assert idm_acceleration(14.0, 12.0, standstill=2.0) == pytest.approx(-2.0)


@pytest.mark.parametrize(
    ("parameters", "says"),
    [
        ({"example": 3}, "allowed: examples"),
        ({"examples": 6}, "from 0 to 5"),
        ({"examples": True}, "from 0 to 5"),
        ({"examples": 2.5}, "from 0 to 5"),
        ({"endpoint": "http://somewhere"}, "allowed: examples"),
    ],
)
def test_parameters_that_it_does_not_take_are_refused(
    parameters: dict[str, object], says: str
) -> None:
    with pytest.raises(ValueError, match=says):
        examples_in(parameters)
    assert (examples_in({}), examples_in({"examples": 0})) == (3, 0)


SETTINGS = {"DRIVORA_DILU_ENDPOINT": "http://localhost:1/v1/", "DRIVORA_DILU_MODEL": "m"}


def test_the_operators_settings_are_read() -> None:
    assert read_endpoint_settings({}) is None
    assert read_endpoint_settings({**SETTINGS, "DRIVORA_DILU_ENDPOINT": " "}) is None
    more = {"DRIVORA_DILU_API_KEY": "secret", "DRIVORA_DILU_TIMEOUT_S": "20"}
    found = read_endpoint_settings({**SETTINGS, **more})
    assert found == EndpointSettings(
        url="http://localhost:1/v1", model="m", api_key="secret", timeout=20.0
    )
    assert "secret" not in repr(found)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"DRIVORA_DILU_MODEL": ""}, "DRIVORA_DILU_MODEL is not"),
        ({"DRIVORA_DILU_ENDPOINT": "localhost/v1"}, "no scheme or host"),
        ({"DRIVORA_DILU_ENDPOINT": "ftp://localhost/v1"}, "allowed: http:// or https://"),
        ({"DRIVORA_DILU_ENDPOINT": "http://u:hush@h:port"}, "is no address"),
        ({"DRIVORA_DILU_API_KEY": "hush\nhush"}, "printable ASCII"),
        ({"DRIVORA_DILU_ENDPOINT": "http://u:hush@h/v1"}, "DRIVORA_DILU_API_KEY"),
        ({"DRIVORA_DILU_ENDPOINT": "http://h/v1?key=hush"}, "DRIVORA_DILU_API_KEY"),
        ({"DRIVORA_DILU_TIMEOUT_S": "soon"}, "seconds above 0"),
        ({"DRIVORA_DILU_TIMEOUT_S": "-1"}, "seconds above 0"),
    ],
)
def test_settings_that_cannot_be_used_are_told_of(change: dict[str, str], says: str) -> None:
    with pytest.raises(ModelError, match=says) as failure:
        read_endpoint_settings({**SETTINGS, **change})
    assert "hush" not in str(failure.value)
