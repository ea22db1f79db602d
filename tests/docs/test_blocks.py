from __future__ import annotations

from tests.docs.blocks import commands_of, installation_lines, missing_lines, renewed_lines

PAGE = """# Page
```sh
make install
```
<!-- file: a/b.txt -->
```yaml
x: 1
```
<!-- fails -->
```console
$ cat a/b.txt
x: 2
$ ls \\
    nowhere
```
```json
{}
```
"""


def test_blocks_become_commands() -> None:
    written, shown, failing = commands_of(PAGE)
    assert "cat > a/b.txt" in written.script
    assert "x: 1" in written.script
    assert (shown.script, shown.expected, shown.fails) == ("cat a/b.txt", ("x: 2",), False)
    assert (failing.script, failing.fails) == ("ls \\\n    nowhere", True)
    assert installation_lines(PAGE) == ["make install"]


def test_lines_are_compared_loosely_and_in_order() -> None:
    printed = "name   12.5 s\n ──────\nother 3 of 4\nend"
    assert missing_lines(("name 7 s", "…", "other 1 of … "), printed) == []
    assert missing_lines(("name 7 m",), printed) == ["name 7 m"]
    assert missing_lines(("end", "name 7 s"), printed) == ["name 7 s"]


def test_numbers_of_results_are_compared_digit_by_digit() -> None:
    printed = "collision at 8.7 s, 5.9 m/s\n100 runs in 6 s (15.70 a second)\ncost 79 µs"
    assert missing_lines(("collision at 8.8 s, 5.9 m/s",), printed, exact=True) != []
    assert missing_lines(("collision at 8.7 s, 5.0 m/s",), printed, exact=True) != []
    assert missing_lines(("collision at 8.7 s, …",), printed, exact=True) == []
    assert missing_lines(("100 runs in 9 s (2.5 a second)",), printed, exact=True) == []
    assert missing_lines(("99 runs in 9 s (2.5 a second)",), printed, exact=True) != []
    assert missing_lines(("cost 12 µs",), printed, exact=True) == []


def test_a_page_is_renewed_with_what_is_printed_now() -> None:
    printed = "name ego_0  8.7 s\n  hit at 5.9 m/s with\nother 3 of 4"
    page = ("name ego_0  8.8 s", "  hit at 5.0 m/s …", "…", "gone 1", "other 3 of 4")
    assert renewed_lines(page, printed) == (
        "name ego_0  8.7 s",
        "  hit at 5.9 m/s …",
        "…",
        "gone 1",
        "other 3 of 4",
    )


def test_a_page_can_go_on_with_the_files_of_another() -> None:
    page = "<!-- files of: docs/how-to/add-an-agent.md -->\n```console\n$ ls careful\n```\n"
    *written, shown = commands_of(page)
    assert shown.script == "ls careful"
    assert any("cat > careful/careful_driver.py" in command.script for command in written)
    assert not any("pip install" in command.script for command in written)
