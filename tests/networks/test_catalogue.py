from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

from drivora_service.errors import NetworkError, UnknownName
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks


@pytest.fixture
def folders(tmp_path: Path, loop_file: Path) -> tuple[Path, Path]:
    """Shipped: ring (with provenance); imported: flat (a file only), ring (hidden by the other)."""
    shipped, imported = tmp_path / "shipped", tmp_path / "imported"
    for folder in (shipped / "ring", imported / "ring"):
        folder.mkdir(parents=True)
        shutil.copy(loop_file, folder / "ring.net.xml")
    (shipped / "ring" / "provenance.yaml").write_text(
        "title: Ring\ndescription: A loop.\nsource: own work\nlicence: Apache-2.0\n"
    )
    shutil.copy(loop_file, imported / "flat.net.xml")
    return shipped, imported


def test_networks_of_both_folders(folders: tuple[Path, Path]) -> None:
    shipped, imported = folders
    assert NetworkCatalogue(shipped).names() == ("ring",)
    catalogue = NetworkCatalogue(shipped, imported)
    assert catalogue.names() == ("flat", "ring")
    assert catalogue.path("flat") == imported / "flat.net.xml"
    assert catalogue.path("ring") == shipped / "ring" / "ring.net.xml"


def test_a_network_is_read_once(folders: tuple[Path, Path]) -> None:
    catalogue = NetworkCatalogue(*folders)
    network = catalogue.get("flat")
    assert network.name == "flat"
    assert catalogue.get("flat") is network


def test_another_catalogue_has_the_network_that_is_read_already(
    folders: tuple[Path, Path],
) -> None:
    shipped, imported = folders
    catalogue, other = NetworkCatalogue(shipped), NetworkCatalogue(shipped, imported)
    network = catalogue.get("ring")
    assert other.get("ring") is network
    assert other.is_current(network)
    # A file of the same size and times in another folder is another network.
    assert NetworkCatalogue(imported).get("ring") is not network
    path = shipped / "ring" / "ring.net.xml"
    path.write_text(path.read_text() + " ")
    assert not other.is_current(network)
    assert other.get("ring") is not network


def test_a_network_is_read_again_when_it_was_imported_again(folders: tuple[Path, Path]) -> None:
    shipped, imported = folders
    catalogue = NetworkCatalogue(shipped, imported)
    before = catalogue.get("flat")
    path = imported / "flat.net.xml"
    path.write_text(path.read_text().replace('netOffset="5.00', 'netOffset="15.00'))
    assert before.net_offset[0] == 5.0
    assert catalogue.get("flat").net_offset[0] == 15.0


def test_an_import_is_found_while_the_process_runs(
    folders: tuple[Path, Path], loop_file: Path
) -> None:
    shipped, imported = folders
    catalogue = NetworkCatalogue(shipped, imported)
    with pytest.raises(UnknownName):
        catalogue.get("new")
    (imported / "new").mkdir()
    shutil.copy(loop_file, imported / "new" / "new.net.xml")
    assert catalogue.get("new").name == "new"


@pytest.mark.parametrize(
    "name", ["", ".", "..", "../imported/flat", "ring/ring", "a b", "ring\n", "r\u00edng", "x" * 65]
)
def test_a_name_is_never_a_path(folders: tuple[Path, Path], name: str) -> None:
    catalogue = NetworkCatalogue(*folders)
    with pytest.raises(UnknownName, match="drivora networks import FILE --name NAME") as caught:
        catalogue.path(name)
    assert caught.value.known == ("flat", "ring")


def test_folders_that_do_not_exist_are_empty(tmp_path: Path) -> None:
    assert NetworkCatalogue(tmp_path / "none", tmp_path / "neither").names() == ()


def test_provenance_lies_beside_the_network(folders: tuple[Path, Path]) -> None:
    catalogue = NetworkCatalogue(*folders)
    provenance = catalogue.provenance("ring")
    assert provenance is not None
    assert (provenance.title, provenance.licence) == ("Ring", "Apache-2.0")
    assert catalogue.provenance("flat") is None


def test_broken_provenance_is_an_error(folders: tuple[Path, Path]) -> None:
    (folders[0] / "ring" / "provenance.yaml").write_text("title: [")
    with pytest.raises(NetworkError, match=r"provenance\.yaml of network 'ring'"):
        NetworkCatalogue(*folders).provenance("ring")


def test_shipped_networks_have_their_provenance() -> None:
    catalogue = NetworkCatalogue(shipped_networks())
    assert catalogue.names()
    for name in catalogue.names():
        provenance = catalogue.provenance(name)
        assert provenance is not None
        assert provenance.licence


def test_a_replacement_is_found_by_more_than_its_time_and_size(folders: tuple[Path, Path]) -> None:
    catalogue = NetworkCatalogue(*folders)
    path = catalogue.path("flat")
    before = catalogue.get("flat")
    assert catalogue.is_current(before)
    other = path.with_name("other")
    other.write_text(path.read_text().replace('netOffset="5.00', 'netOffset="9.00'))
    times = path.stat()
    os.utime(other, ns=(times.st_atime_ns, times.st_mtime_ns))
    other.replace(path)
    assert not catalogue.is_current(before)
    after = catalogue.get("flat")
    assert (before.net_offset[0], after.net_offset[0]) == (5.0, 9.0)
    assert not catalogue.is_current(before)
    assert catalogue.is_current(after)
    path.unlink()
    assert not catalogue.is_current(after)
