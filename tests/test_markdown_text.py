from __future__ import annotations

import re
from html import unescape
from html.parser import HTMLParser

import pytest
from hypothesis import given
from hypothesis import strategies as st
from markdown_it import MarkdownIt

from drivora_service.markdown_text import (
    Markdown,
    code_span,
    escape_markdown,
    escape_prose,
    table,
)
from tests.hostile_names import NAMES, acting_characters


class _Cells(HTMLParser):
    """The text of each cell of the tables of a page."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.feed(page)

    def handle_starttag(self, tag: str, _attributes: object) -> None:
        if tag == "tr":
            self.rows.append([])
        elif tag in {"td", "th"}:
            self.rows[-1].append("")

    def handle_data(self, data: str) -> None:
        if self.rows and self.rows[-1] and data.strip():
            self.rows[-1][-1] += data


def _read(lines: list[str]) -> list[list[str]]:
    return _Cells(MarkdownIt("commonmark").enable("table").render("\n".join(lines))).rows


plain = st.text(
    st.sampled_from("ab1_*`[|\\<&~")
    | st.characters(codec="utf-8", categories=["L", "N", "P", "S"]),
    max_size=12,
)


@given(st.lists(st.tuples(plain, plain), max_size=4))
def test_a_reader_of_markdown_finds_the_cells_as_they_were_meant(
    rows: list[tuple[str, str]],
) -> None:
    assert _read(table(("a|b", "`c`"), rows)) == [["a|b", "`c`"], *(list(row) for row in rows)]


@given(plain)
def test_a_reader_of_markdown_finds_a_line_as_it_was_meant(text: str) -> None:
    read = MarkdownIt("commonmark").render(f"- {escape_markdown(text)} x")
    assert unescape(read) == f"<ul>\n<li>{text} x</li>\n</ul>\n".replace("<li> ", "<li>")


def test_a_cell_that_is_markdown_stays_as_it_is() -> None:
    *_, row = table(("agent",), [(Markdown("[`idm`](idm.md)"),)])
    assert row == "| [`idm`](idm.md) |"


def test_line_breaks_of_a_text_do_not_end_its_line() -> None:
    assert escape_markdown("one\ntwo\r\n three") == "one two three"


def test_names_stay_legible() -> None:
    assert escape_markdown("tee-town_0001 of _a_ | b") == "tee-town_0001 of \\_a\\_ \\| b"


@pytest.mark.parametrize("name", NAMES)
def test_prose_and_code_show_any_text_and_no_markup(name: str) -> None:
    for line in (f"- {escape_prose(name)}", escape_prose(f"run `{name}` again"), code_span(name)):
        page = MarkdownIt("commonmark").render(line)
        assert set(re.findall(r"<(\w+)", page)) <= {"ul", "li", "p", "code"}
        assert acting_characters(line) == []


def test_commands_in_prose_stay_code() -> None:
    line = escape_prose("give `drivora runs show <id>` *now*, a ` is one")
    assert line == "give `drivora runs show <id>` \\*now\\*, a \\` is one"


def test_code_may_have_backticks() -> None:
    assert code_span("a ``b`` c`") == "``` a ``b`` c` ```"
    assert code_span("") == "`  `"
