"""Campaigns in the spaces of papers: from the file to the result, the same on any way there."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from drivora_service.cli.campaigns.campaign_files import shipped_campaigns
from drivora_service.search.space.presets import PRESETS
from tests.campaigns.analytic import sequence
from tests.cli.campaigns.test_campaign_commands import begin_campaign, evaluations, wait_until_told
from tests.cli.conftest import Drivora

SIMULATIONS = 12
KILLED_AMONG = 60
"""Simulations of the campaign that is killed: it must not be over before."""


def campaign_of(
    method: str, space: dict[str, object], folder: Path, simulations: int = SIMULATIONS
) -> Path:
    """Writes the file of a campaign on the motorway, or of egos at a junction."""
    name = "side-collision" if space["preset"] == "doppeltest" else "late-braking"
    document = yaml.safe_load((shipped_campaigns() / f"{name}.yaml").read_text())
    document["scenario"]["file"] = str(shipped_campaigns() / document["scenario"]["file"])
    document |= {"tester": {"name": method}, "space": space, "lookahead": 4}
    document["budget"] = {"simulations": simulations}
    path = folder / "campaign.yaml"
    path.write_text(yaml.safe_dump(document))
    return path


def test_presets_are_listed(drivora: Drivora) -> None:
    listed = drivora("campaign", "presets", "--json").json()
    assert [one["name"] for one in listed] == [name.value for name in PRESETS]
    by_name = {one["name"]: one for one in listed}
    assert by_name["default"]["options"] == {}
    assert by_name["avfuzzer"]["options"]["slice_time"] == 3.0
    assert by_name["behavexplor"]["options"]["at_end"] == "stay"
    printed = drivora("campaign", "presets").out
    assert all(name.value in printed for name in PRESETS)


def test_an_unknown_preset_is_refused_with_its_place(drivora: Drivora, tmp_path: Path) -> None:
    path = campaign_of("random", {"preset": "avfuzzr"}, tmp_path)
    refused = drivora("campaign", "run", path)
    assert refused.code == 2
    assert "/space/preset" in refused.err
    assert "'default', 'avfuzzer', 'behavexplor' or 'doppeltest'" in refused.err


@pytest.mark.slow
@pytest.mark.parametrize(
    ("method", "preset", "genes"),
    [
        ("random", "avfuzzer", 20),
        ("avfuzzer", "avfuzzer", 20),
        ("behavexplor", "avfuzzer", 20),
        ("samota", "avfuzzer", 20),
        ("behavexplor", "behavexplor", 70),
        ("doppeltest", "doppeltest", None),
    ],
)
def test_every_method_searches_the_spaces(
    method: str, preset: str, genes: int | None, drivora: Drivora, tmp_path: Path
) -> None:
    path = campaign_of(method, {"preset": preset}, tmp_path)
    ended = drivora("campaign", "run", path, "--workers", "1", "--json")
    assert ended.code == 0, ended.err
    shown = ended.json()
    assert (shown["state"], shown["simulations"]) == ("finished", SIMULATIONS)
    assert f"note: the space is the preset {preset!r}" in ended.err
    records = evaluations(tmp_path, shown["id"])
    assert all(record.status.value == "judged" for record in records)
    if genes is not None:
        assert {len(record.proposal.values) for record in records} == {genes}


@pytest.mark.slow
def test_workers_and_kills_change_nothing(drivora: Drivora, tmp_path: Path) -> None:
    own = {"preset": "avfuzzer", "max_deceleration": 6.0, "weather": True}
    path = campaign_of("avfuzzer", own, tmp_path, KILLED_AMONG)
    process = begin_campaign(tmp_path, "run", path, "--workers", "2")
    campaign_id = wait_until_told(tmp_path, process, 0)
    process.kill()
    assert 0 < len(evaluations(tmp_path, campaign_id)) < KILLED_AMONG
    ended = drivora("campaign", "resume", campaign_id, "--workers", "2", "--json")
    assert ended.code == 0, ended.err
    killed = _result(tmp_path, campaign_id)
    ended = drivora("campaign", "run", path, "--workers", "1", "--json")
    assert ended.code == 0, ended.err
    assert killed == _result(tmp_path, ended.json()["id"])


def _result(folder: Path, campaign_id: str) -> tuple[object, ...]:
    records = evaluations(folder, campaign_id)
    assert len(records) >= KILLED_AMONG
    return sequence(records), [record.report.trace_sha256 for record in records if record.report]
