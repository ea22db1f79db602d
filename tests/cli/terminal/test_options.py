from __future__ import annotations

from pathlib import Path

import pytest

from drivora_service.cli.terminal.options import location


@pytest.mark.parametrize(
    ("server", "data_dir", "options"),
    [
        ("", None, ""),
        ("", Path("my data"), "--data-dir 'my data'"),
        ("http://127.0.0.1:8000", None, "--server http://127.0.0.1:8000"),
    ],
)
def test_printed_commands_ask_the_same_place(
    server: str, data_dir: Path | None, options: str
) -> None:
    assert location(server, data_dir) == options
