from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.oracles.laws.formula import And, Comparison, Implies, Or, Until, signals_of
from drivora_service.oracles.laws.law_tokens import FormulaError
from drivora_service.oracles.laws.parsing import MAX_DEPTH, Quantity, read_law
from drivora_service.oracles.laws.units import METRE, ONE, SECOND

PARAMETERS = {
    "excess": Quantity(value=0.05, unit=ONE),
    "patience": Quantity(value=3.0, unit=SECOND),
    "room": Quantity(value=10.0, unit=METRE),
}


def read(condition: str) -> object:
    formula, _ = read_law(f"always ({condition}\n)", PARAMETERS)
    return formula


def test_a_comparison_is_a_scaled_sum() -> None:
    found = read("speed <= (1 + excess) * speed_limit - 2")
    assert isinstance(found, Comparison)
    assert dict(found.terms) == {"speed": -1.0, "speed_limit": pytest.approx(1.05)}
    assert found.constant == -2.0
    assert found.scale == pytest.approx(10.5), "the greatest of the signals' scales"
    assert str(found) == "speed <= (1 + excess) * speed_limit - 2"


def test_numbers_are_added_divided_and_negated() -> None:
    found = read("-2 * speed / 4 + 3 > -speed_limit")
    assert isinstance(found, Comparison)
    assert dict(found.terms) == {"speed": -0.5, "speed_limit": 1.0}
    assert found.constant == 3.0


def test_a_parameter_with_a_unit_makes_metres_of_a_speed() -> None:
    found = read("leader_gap >= patience * speed + room")
    assert isinstance(found, Comparison)
    assert dict(found.terms) == {"leader_gap": 1.0, "speed": -3.0}
    assert found.constant == -10.0


@pytest.mark.parametrize(
    ("written", "same"),
    [
        ("in_junction or turning and light_red", "in_junction or (turning and light_red)"),
        ("in_junction -> turning -> light_red", "in_junction -> (turning -> light_red)"),
        ("in_junction or turning -> light_red", "(in_junction or turning) -> light_red"),
        ("not in_junction and turning", "(not in_junction) and turning"),
        ("in_junction and turning until[0:2] light_red",
         "in_junction and (turning until[0:2] light_red)"),
        ("once[0:2] in_junction and turning", "(once[0:2] in_junction) and turning"),
        ("in_junction implies turning && light_red || !turning",
         "in_junction -> (turning and light_red) or (not turning)"),
        ("eventually[1:patience] (turning) # why", "eventually[1:3] turning"),
    ],
)  # fmt: skip
def test_precedence_and_spellings(written: str, same: str) -> None:
    assert str(read(written)) == str(read(same))
    assert signals_of(read_law(f"always ({written}\n)", PARAMETERS)[0]) == signals_of(
        read_law(f"always ({same})", PARAMETERS)[0]
    )


def test_structure() -> None:
    found = read("in_junction and turning -> light_red or speed > 3 until[0:1] lane_change")
    assert isinstance(found, Implies)
    assert isinstance(found.condition, And)
    assert isinstance(found.consequence, Or)
    assert isinstance(found.consequence.parts[1], Until)


@pytest.mark.parametrize(
    ("text", "at", "message"),
    [
        ("speed < 3", "speed", "a law is `always"),
        ("always[0:3] (speed < 3)", "[", "the `always` that begins a law has none"),
        ("always (speed < 3) and turning", "and", "expected an operator, or the end"),
        ("always (speed < 3", "", "expected ')' for the bracket at character 8"),
        ("always (sped < 3)", "sped", "did you mean 'speed'?"),
        ("always (speed)", "(speed)", "the value `(speed)` in m/s where a condition is needed"),
        ("always (turning < 3)", "3", "the condition `turning` where a measured value is needed"),
        ("always (speed < leader_gap)", "<", "in m cannot be compared: the units differ"),
        ("always (speed + leader_gap < 3)", "+", "cannot be added: the units differ"),
        ("always (speed < patience)", "<", "the units differ"),
        ("always (speed * speed < 3)", "*", "the product of the signals"),
        ("always (3 / speed < 3)", "/", "as a divisor"),
        ("always (speed / 0 < 3)", "/", "found 0 as a divisor"),
        ("always (2 < 3)", "<", "names no signal whose value matters"),
        ("always (speed - speed < 3)", "<", "names no signal whose value matters"),
        ("always (1 < speed < 3)", "< 3", "a second comparison"),
        ("always (speed = 3)", "=", "compared by <=, <, >= or >"),
        ("always (speed < 3 $)", "$", "allowed are names, numbers"),
        ("always (eventually (turning))", "(turning", "expected its interval in seconds"),
        ("always (turning until light_red)", "light_red", "expected its interval in seconds"),
        ("always (eventually[3:1] turning)", "3:1", "is empty or negative"),
        ("always (eventually[-1:1] turning)", "-1", "is empty or negative"),
        ("always (eventually[0:90] turning)", "0:90", "at most 60 s"),
        ("always (turning until[0:11] light_red)", "0:11", "at most 10 s"),
        ("always (eventually[0:speed] turning)", "speed", "numbers or parameters in s"),
        ("always (eventually[0:room] turning)", "room", "are in s"),
        ("always (eventually[0 3] turning)", "3]", "expected ':'"),
        ("always (eventually[0:3 turning)", "turning", "expected ']'"),
        ("always ()", ")", "expected a signal, a parameter"),
        ("always (not)", ")", "expected a signal, a parameter"),
        ("always (2e9 < speed)", "2e9", "at most 1e9"),
    ],
)
def test_mistakes_are_named_with_their_place(text: str, at: str, message: str) -> None:
    with pytest.raises(FormulaError) as refused:
        read_law(text, PARAMETERS)
    assert message in str(refused.value)
    assert text[refused.value.offset :].startswith(at)
    assert at or refused.value.offset == len(text)


def test_an_unknown_name_lists_the_known_ones() -> None:
    with pytest.raises(FormulaError, match=r"light_distance.*excess, patience, room"):
        read("nothing")


@pytest.mark.parametrize("deep", ["(" * 500, "not " * 500, "-" * 500, "turning -> " * 300])
def test_depth_is_bounded(deep: str) -> None:
    with pytest.raises(FormulaError, match=f"more than {MAX_DEPTH}"):
        read(deep + "turning")


def test_length_is_bounded() -> None:
    with pytest.raises(FormulaError, match="at most 4000"):
        read("turning or " * 1000 + "turning")


@given(st.text(alphabet="()[]:<>=-+*/ andortuniligspe0129._", max_size=60))
def test_any_text_is_read_or_refused_with_a_place(text: str) -> None:
    refused: FormulaError | None = None
    try:
        read_law("always (" + text, PARAMETERS)
    except FormulaError as error:
        refused = error
    assert refused is None or 0 <= refused.offset <= len(text) + len("always (")
