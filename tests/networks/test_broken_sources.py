"""Broken OpenDRIVE and OpenStreetMap files: refused within the time limit, and nothing is left."""

from __future__ import annotations

import resource
import tempfile
from pathlib import Path

import pytest

from drivora_service.errors import NetworkError
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.networks.importing import netconvert
from drivora_service.networks.importing.network_importing import import_network
from tests.networks.broken_sources import SOURCES, opendrive, road

MAX_SECONDS = 20.0
"""Of a conversion here; all but those that never end take less than one on an idle machine."""
ENDLESS = ("OSM, a million lanes", "OSM, way of one node over and over")
ENDLESS_SECONDS = 3.0
"""Of a conversion that does not end, so that its time limit refuses it."""


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder in which this process makes temporary files."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("name", SOURCES)
def test_broken_sources(name: str, repository: Path, tmp_path: Path, temporary: Path) -> None:
    broken = SOURCES[name]
    source = tmp_path / broken.file_name
    source.write_bytes(broken.make())
    into = tmp_path / "imported"
    shipped = NetworkCatalogue(repository / "sumo_nets").names()
    names: tuple[str, ...] = ()
    refusal = ""
    try:
        seconds = ENDLESS_SECONDS if name in ENDLESS else MAX_SECONDS
        import_network(source, "town", into, max_seconds=seconds)
        names = ("town",)
    except NetworkError as error:
        refusal = str(error)
    assert broken.is_usable in (None, bool(names)), refusal
    assert names or source.name in refusal
    assert "no reason" not in refusal
    assert [path.name for path in into.glob("*")] == list(names)
    assert list(temporary.iterdir()) == []
    catalogue = NetworkCatalogue(repository / "sumo_nets", into)
    assert set(catalogue.names()) == {*shipped, *names}
    for known in names:
        assert any(lane.drivable for lane in catalogue.get(known).lanes)


@pytest.mark.parametrize(
    ("limit", "most"), [(resource.RLIMIT_FSIZE, 1000), (resource.RLIMIT_AS, 50_000_000)]
)
def test_a_conversion_beyond_its_limits_is_refused(
    limit: int, most: int, tmp_path: Path, temporary: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(netconvert, "_LIMITS", ((limit, most),))
    source = tmp_path / "town.xodr"
    source.write_text(opendrive(*(road(str(i), y=str(20 * i)) for i in range(200))))
    with pytest.raises(NetworkError, match=r"netconvert (crashed|failed)"):
        import_network(source, "town", tmp_path / "imported")
    assert list((tmp_path / "imported").iterdir()) == []
    assert list(temporary.iterdir()) == []


def test_a_crash_is_told_by_its_signal(tmp_path: Path) -> None:
    program = tmp_path / "crashing"
    program.write_text("#!/bin/sh\necho 'Error: nearly done.'\nkill -SEGV $$\n")
    program.chmod(0o755)
    with pytest.raises(NetworkError, match=r"crashed \(SIGSEGV\): nearly done"):
        netconvert.run_converter(program, [], tmp_path / "out", timeout=60.0)


def test_what_does_not_end_is_ended(tmp_path: Path) -> None:
    program = tmp_path / "waiting"
    program.write_text("#!/bin/sh\nexec sleep 1000\n")
    program.chmod(0o755)
    with pytest.raises(NetworkError, match=r"did not finish within 0\.5 s; cut out the part"):
        netconvert.run_converter(program, [], tmp_path / "out", timeout=0.5)
