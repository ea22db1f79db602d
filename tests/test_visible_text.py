from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.visible_text import describe_acting_character, visible_text
from tests.hostile_names import ACTING, FORMULAS, MARKUP, acting_characters


@pytest.mark.parametrize("name", ACTING)
def test_what_acts_is_found_and_written_visibly(name: str) -> None:
    assert describe_acting_character(name).startswith("U+")
    assert acting_characters(visible_text(name)) == []
    assert "\n" not in visible_text(name)


@pytest.mark.parametrize("name", [*MARKUP, *FORMULAS, "می‌خواهم", "👩‍🚒"])
def test_what_does_not_act_stays(name: str) -> None:
    assert describe_acting_character(name) == ""
    assert visible_text(name) == name


def test_each_character_is_written_as_in_json() -> None:
    text = "a\x1b[1m\x7f\r\n\t\x9b\u202e\ud800\U000e0041"
    written = visible_text(text)
    assert written == "a\\u001b[1m\\u007f\\r\\n\\t\\u009b\\u202e\\ud800\\udb40\\udc41"
    assert json.loads(f'"{written}"') == text


@given(st.recursive(st.text(), lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner)))
def test_a_document_of_json_stays_what_it_is(content: object) -> None:
    document = json.dumps(content, ensure_ascii=False, indent=2)
    assert json.loads(visible_text(document, has_lines=True)) == content


def test_lines_stay_where_there_may_be_several() -> None:
    assert visible_text("a\r\n\tb\rc\x1b", has_lines=True) == "a\n\tb\\rc\\u001b"
    assert describe_acting_character("a\n\tb", has_lines=True) == ""


def test_the_first_one_is_described() -> None:
    described = describe_acting_character("abc\u202egpj\x1b")
    assert described == "U+202E (right-to-left override) as character 4 of 8"
    assert describe_acting_character("\x1b") == "U+001B (escape) as character 1 of 1"


@given(st.text())
def test_no_text_acts_once_it_is_visible(text: str) -> None:
    assert acting_characters(visible_text(text, has_lines=True)) == []
    assert visible_text(text).isascii() or not text.isascii()
