"""``--out``: refused before the work if it cannot be written; its files have the user's modes."""

from __future__ import annotations

import json
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from drivora_service.cli.exit_codes import ExitCode
from tests.api.test_campaigns import small_campaign
from tests.cli.conftest import Drivora


def modes(folder: Path) -> dict[str, str]:
    """Returns the modes of a folder and of all that is in it."""
    return {
        str(path.relative_to(folder)): f"{stat.S_IMODE(path.lstat().st_mode):o}"
        for path in (folder, *folder.rglob("*"))
    }


@pytest.mark.slow(seconds=20)
def test_results_have_the_modes_of_the_user_and_stored_data_is_private(
    tmp_path: Path, scenario_file: Path
) -> None:
    data, out = tmp_path / "data", tmp_path / "out"
    campaign = tmp_path / "campaign.json"
    campaign.write_text(json.dumps(small_campaign("random")))

    def drivora(*arguments: str | Path) -> None:
        command = [sys.executable, "-m", "drivora_service.cli", *map(str, arguments)]
        subprocess.run([*command, "--data-dir", str(data)], check=True, umask=0o022)

    one = "--workers", "1"
    drivora("run", scenario_file, "--agent", "sumo-idm", "--out", out / "run", *one)
    drivora("campaign", "run", campaign, "--out", out / "campaign", *one)
    drivora("plot", out / "run" / "crossing.trace.parquet", "--out", out / "picture.svg")
    stored, written = modes(data), modes(out)
    assert "drivora.sqlite3" in stored
    assert list(data.glob("traces/**/*.parquet"))
    assert {name: mode for name, mode in stored.items() if int(mode, 8) & 0o77} == {}
    assert {"run/crossing.trace.parquet", "run/crossing.report.json"} <= written.keys()
    assert {"campaign/campaign.json", "picture.svg"} <= written.keys()
    assert {name: mode for name, mode in written.items() if mode not in ("644", "755")} == {}


@pytest.mark.parametrize(
    "arguments",
    [
        "run crossing.json",
        "campaign run campaign.json",
        "campaign compare c1",
        "campaign report c1",
        "campaign scenario c1 0",
        "runs scenario r1",
        "plot r1",
        "agents benchmark idm --runs 1",
    ],
)
def test_a_place_that_cannot_be_written_is_refused_before_the_work(
    drivora: Drivora, scenario_file: Path, tmp_path: Path, arguments: str
) -> None:
    (tmp_path / "campaign.json").write_text(json.dumps(small_campaign("random")))
    ended = drivora(*arguments.split(), "--out", scenario_file / "below.svg" / "x.svg")
    assert ended.code == ExitCode.USAGE_ERROR
    assert f"cannot write {scenario_file}" in ended.err
    assert "Traceback" not in ended.err
    assert not (tmp_path / "data").exists()
