"""Choosing scenarios of a suite."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.errors import ConfigurationError
from drivora_service.suites.scenario_selection import choose, read_expression, read_shard
from drivora_service.suites.suite import SuiteScenario
from tests.suites.made_results import DOCUMENT

SCENARIOS = [
    SuiteScenario(name=name, document=DOCUMENT, tags=tags)
    for name, tags in (
        ("left-turn", ("smoke", "wet")),
        ("left-lane", ("smoke",)),
        ("roundabout", ("wet",)),
        ("motorway", ()),
    )
]


def names(expression: str = "", **restrictions: object) -> list[str]:
    chosen = choose(SCENARIOS, expression=expression, **restrictions)  # type: ignore[arg-type]  # restrictions are keyword arguments
    return [one.name for one in chosen]


def test_words_are_looked_for_in_names_and_tags() -> None:
    assert names("left") == ["left-turn", "left-lane"]
    assert names("left and not wet") == ["left-lane"]
    assert names("not (left or motorway)") == ["roundabout"]
    assert names("not left and wet or motorway") == ["roundabout", "motorway"]
    assert names("wet", tags=["smoke"]) == ["left-turn"]
    assert names(tags=["smoke", "wet"]) == ["left-turn", "left-lane", "roundabout"]
    assert names(names={"motorway", "left-lane"}) == ["left-lane", "motorway"]


@pytest.mark.parametrize(
    ("expression", "message"),
    [
        ("left and", "found 'the end', where a word is expected"),
        ("(left", "found no closing parenthesis"),
        ("left wet", "found 'wet', where `and`, `or` or the end is expected"),
        ("(" * 9999 + "left", "found more than 50 parentheses around each other"),
        (")", "found '\\)', where a word is expected"),
        ("nothing", "none of the 4 scenarios is chosen"),
    ],
)
def test_expressions_that_choose_nothing_are_refused(expression: str, message: str) -> None:
    with pytest.raises(ConfigurationError, match=message):
        names(expression)


def test_an_unknown_tag_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ConfigurationError, match="--tag dry: no scenario has it; tags: smoke, wet"):
        names(tags=["dry"])


_EXPRESSIONS = st.recursive(
    st.sampled_from(["left", "wet", "smoke", "o"]),
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from(["and", "or"]), inner).map(" ".join),
        inner.map("not {}".format),
        inner.map("({})".format),
    ),
    max_leaves=12,
)


@given(_EXPRESSIONS)
def test_expressions_mean_what_they_mean_in_python(expression: str) -> None:
    condition = read_expression(expression)
    for one in SCENARIOS:
        texts = (one.name, *one.tags)
        known = {
            word: any(word in text for text in texts) for word in ("left", "wet", "smoke", "o")
        }
        assert condition(one) == eval(expression, {}, known)


@given(st.integers(1, 12), st.integers(1, 12))
def test_shards_are_a_partition_of_about_the_same_sizes(count: int, of: int) -> None:
    scenarios = [SuiteScenario(name=str(number), document=DOCUMENT) for number in range(count)]
    parts = []
    for number in range(1, of + 1):
        shard = read_shard(f"{number}/{of}")
        if number <= count:
            parts.append(choose(scenarios, shard=shard))
        else:
            with pytest.raises(ConfigurationError, match="scenarios are chosen; use at most"):
                choose(scenarios, shard=shard)
    assert sorted(one.name for part in parts for one in part) == sorted(map(str, range(count)))
    assert max(map(len, parts)) - min(map(len, parts)) <= 1


@pytest.mark.parametrize("text", ["", "1", "0/2", "3/2", "1/0", "a/b", "-1/2"])
def test_shards_that_do_not_exist_are_refused(text: str) -> None:
    with pytest.raises(ConfigurationError, match="give the number of a part"):
        read_shard(text)
