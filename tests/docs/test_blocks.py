from __future__ import annotations

from tests.docs.blocks import commands_of, installation_lines, missing_lines

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
