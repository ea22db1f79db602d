from __future__ import annotations

import threading
from pathlib import Path

import pytest

from drivora_service.errors import NetworkTaken
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.networks.importing.staging import (
    UPLOADING,
    make_stage,
    open_stage,
    publish,
    remove_left_uploads,
)


def made(into: Path, name: str, text: str) -> Path:
    """A network that is ready to be published."""
    folder = make_stage(into, UPLOADING) / "new"
    folder.mkdir()
    (folder / f"{name}.net.xml").write_text(text)
    (folder / "provenance.yaml").write_text(f"title: {text}\n")
    return folder


def test_a_name_that_is_taken_meanwhile(tmp_path: Path) -> None:
    publish(made(tmp_path, "town", "first"), tmp_path / "town", replace=False)
    with pytest.raises(NetworkTaken, match="'town' is already imported"):
        publish(made(tmp_path, "town", "second"), tmp_path / "town", replace=False)
    assert (tmp_path / "town" / "town.net.xml").read_text() == "first"


def test_a_network_is_there_at_any_time_while_it_is_replaced(tmp_path: Path) -> None:
    publish(made(tmp_path, "town", "0"), tmp_path / "town", replace=False)
    catalogue = NetworkCatalogue(tmp_path / "none", tmp_path)
    ended = threading.Event()
    failures: list[Exception] = []

    def look() -> None:
        while not ended.is_set():
            try:
                assert catalogue.path("town").read_text().isdecimal()
                assert catalogue.names() == ("town",)
            except Exception as error:
                failures.append(error)
                return

    reader = threading.Thread(target=look)
    reader.start()
    for number in range(1, 200):
        publish(made(tmp_path, "town", str(number)), tmp_path / "town", replace=True)
    ended.set()
    reader.join()
    assert failures == []
    assert (tmp_path / "town" / "town.net.xml").read_text() == "199"
    assert (tmp_path / "town" / "provenance.yaml").read_text() == "title: 199\n"


def test_only_uploads_are_removed_at_the_start_of_a_service(tmp_path: Path) -> None:
    publish(made(tmp_path, "town", "0"), tmp_path / "town", replace=False)
    with open_stage(tmp_path) as of_a_command:
        remove_left_uploads(tmp_path)
        assert {path.name for path in tmp_path.iterdir()} == {"town", of_a_command.name}
    remove_left_uploads(tmp_path / "none")
