"""Checkpoints of testers in the folder of a campaign."""

from __future__ import annotations

from pathlib import Path

from drivora_service.campaigns.records.campaign_folder import FolderCheckpoints


def test_the_latest_of_stored_evaluations_is_taken(tmp_path: Path) -> None:
    folder = tmp_path / "campaign" / "checkpoints"
    assert FolderCheckpoints(folder, 10).last() is None
    kept = FolderCheckpoints(folder, 0)
    kept.save(50, b"one")
    kept.save(100, b"two")
    assert FolderCheckpoints(folder, 49).last() is None
    assert FolderCheckpoints(folder, 99).last() == (50, b"one")
    assert FolderCheckpoints(folder, 100).last() == (100, b"two")


def test_the_last_two_are_kept(tmp_path: Path) -> None:
    kept = FolderCheckpoints(tmp_path, 0)
    for told in (2, 4, 6, 10):
        kept.save(told, bytes(told))
    (tmp_path / "notes.txt").write_text("of a user")
    assert sorted(path.name for path in tmp_path.glob("*.checkpoint")) == [
        "00000006.checkpoint", "00000010.checkpoint",
    ]  # fmt: skip
    assert FolderCheckpoints(tmp_path, 9).last() == (6, bytes(6))


def test_a_folder_that_cannot_be_written_costs_no_campaign(tmp_path: Path) -> None:
    place = tmp_path / "file"
    place.write_text("no folder")
    kept = FolderCheckpoints(place, 9)
    kept.save(5, b"state")
    assert kept.last() is None
