from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.cli.terminal.table_layout import shorten_text, table_lines, table_of

KINDS = (
    "kind",
    "count",
    "at fault",
    "avoidable",
    "confirmed",
    "flaky",
    "groups",
    "first",
)
KIND = "deadlock | junction market_church | cycle of 2"
ID = "01a2046cae3d39744e9b7b9f"
MESSAGE = "Collided with ego_1 at 12.4 m/s on the lane beside the one of its route."


@pytest.mark.parametrize("width", [60, 80, 100, 120, 200])
def test_a_kind_and_an_id_are_never_broken(width: int) -> None:
    row = (KIND, "2", "0", "0", "2", "0", "2", "#86")
    head, body = table_lines(table_of(KINDS, [row]), width)
    assert sum(KIND in line for line in body) == 1
    assert max(len(line) for line in (*head, *body)) <= width
    ids = table_of(("id", "name", "state"), [(ID, "n" * 90, "running")], cut=("name",))
    assert sum(ID in line for line in table_lines(ids, width)[1]) == 1


def test_numbers_stand_below_a_kind_that_leaves_no_room_for_them() -> None:
    rows = [(KIND, "2", "0", "0", "2", "0", "2", "#86"), ("short", *"1234567")]
    head, body = table_lines(table_of(KINDS, rows), 80)
    assert head[0].strip() == "kind"
    assert [line.split() for line in body] == [
        KIND.split(),
        ["2", "0", "0", "2", "0", "2", "#86"],
        ["short"],
        ["1", "2", "3", "4", "5", "6", "7"],
    ]


def test_a_wide_table_is_left_as_it_is() -> None:
    row = (KIND, "2", "0", "0", "2", "0", "2", "#86")
    head, body = table_lines(table_of(KINDS, [row]), 120)
    assert len(head) == 2
    assert len(body) == 1


def test_prose_wraps_beside_its_row_or_stands_below_it() -> None:
    table = table_of(
        ("oracle", "ego", "outcome", "message"),
        [("collision", "ego_0", "violated", MESSAGE)],
        wrap=("message",),
    )
    _, beside = table_lines(table, 80)
    assert beside[0].split()[:3] == ["collision", "ego_0", "violated"]
    assert "Collided" in beside[0]
    _, below = table_lines(table, 44)
    assert below[0].split() == ["collision", "ego_0", "violated"]
    assert " ".join(" ".join(below[1:]).split()) == MESSAGE


@pytest.mark.parametrize("width", [30, 50, 80, 120])
def test_a_heading_stands_once_above_its_rows_at_any_width(width: int) -> None:
    places = ("a scenario with a long name, idm",) * 2 + ("another scenario, pdm-closed",)
    rows = [("random", "12"), ("avfuzzer", "7"), ("random", "0")]
    table = table_of(("method", "failing"), rows, headings=places)
    head, body = table_lines(table, width)
    assert max(len(line) for line in (*head, *body)) <= width
    assert " ".join(" ".join(body).split()) == (
        f"{places[0]} random 12 avfuzzer 7 {places[2]} random 0"
    )
    own = [line for line in body if line.startswith("   ")]
    assert [line.split() for line in own] == [[*row] for row in rows]
    # Also where the first column stands above the others.
    narrow = table_of(("method", "failing"), [("m" * 40, "12")], headings=("place",))
    assert table_lines(narrow, 44)[1] == [" place", f"   {'m' * 40}", "     12"]


def test_heads_break_at_spaces_before_anything_is_cut() -> None:
    table = table_of(("step cost", "agent cost"), [("14", "15")])
    assert table_lines(table, 15)[0][:2] == [" step  agent", " cost  cost"]


def test_the_middle_of_a_text_is_left_out() -> None:
    assert shorten_text("abcdefghij", 7) == "abc…hij"
    assert shorten_text("abcdefg", 7) == "abcdefg"


def test_escape_sequences_do_not_reach_the_terminal() -> None:
    table = table_of(("name",), [("\x1b[31mred\x1b[0m\nline",)])
    assert table_lines(table, 80)[1] == [" red line"]


_TEXTS = st.text(st.characters(codec="utf-8", categories=["L", "N", "P"]), max_size=40)


@given(st.lists(st.tuples(_TEXTS, _TEXTS, _TEXTS), min_size=1, max_size=4), st.integers(20, 140))
def test_nothing_but_the_middle_of_cut_columns_is_lost(
    rows: list[tuple[str, str, str]], width: int
) -> None:
    table = table_of(("first", "second", "third"), rows, wrap=("second",), cut=("third",))
    shown = "".join("".join(table_lines(table, width)[1]).split())
    for first, second, third in rows:
        assert first in shown
        assert second in shown
        assert shorten_text(third, 14)[:1] in shown
