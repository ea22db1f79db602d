import shutil
import sys
from pathlib import Path

import pytest

from drivora_service.errors import NetworkError
from drivora_service.networks.shipped_build import find_outdated_files, main, rebuild, sources


@pytest.fixture
def copied(repository: Path, tmp_path: Path) -> Path:
    """One shipped network in a directory that a test may change."""
    shutil.copytree(repository / "sumo_nets" / "tee-town", tmp_path / "tee-town")
    return tmp_path


def test_the_committed_networks_are_what_their_sources_give(repository: Path) -> None:
    networks = repository / "sumo_nets"
    assert [path.name for path in sources(networks)] == [
        "arterial",
        "highway",
        "old-town",
        "roundabout",
        "rural",
        "signal-grid",
        "tee-town",
    ]
    assert find_outdated_files(networks) == ()


def test_a_changed_source_is_noticed_and_rebuilt(copied: Path) -> None:
    nodes = copied / "tee-town" / "plain" / "tee-town.nod.xml"
    original = nodes.read_text(encoding="utf-8")
    network = copied / "tee-town" / "tee-town.net.xml"
    committed = network.read_bytes()
    changed = original.replace('x="130.00" y="76.00"', 'x="130.00" y="80.00"')
    assert changed != original
    nodes.write_text(changed, encoding="utf-8")

    assert find_outdated_files(copied) == ("tee-town/tee-town.net.xml",)
    assert network.read_bytes() == committed
    assert rebuild(copied) == ("tee-town/tee-town.net.xml",)
    assert network.read_bytes() != committed
    assert find_outdated_files(copied) == ()

    nodes.write_text(original, encoding="utf-8")
    rebuild(copied)
    assert network.read_bytes() == committed


def test_another_netconvert_in_the_provenance_is_noticed(copied: Path) -> None:
    provenance = copied / "tee-town" / "provenance.yaml"
    text = provenance.read_text(encoding="utf-8")
    provenance.write_text(text.replace("netconvert: 1.28.0", "netconvert: 1.20.0"), "utf-8")
    assert find_outdated_files(copied) == ("tee-town/provenance.yaml",)


def test_the_command_tells_differences_by_its_exit_code(
    copied: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["--check", "--networks", str(copied)]) == 0
    (copied / "tee-town" / "tee-town.net.xml").write_text("<net/>", encoding="utf-8")
    assert main(["--check", "--networks", str(copied)]) == 1
    assert "differs: tee-town/tee-town.net.xml" in capsys.readouterr().out
    assert main(["--networks", str(copied)]) == 0
    assert main(["--check", "--networks", str(copied)]) == 0


def test_a_directory_without_sources_is_an_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["--check", "--networks", str(tmp_path)]) == 2
    assert "no network with plain sources" in capsys.readouterr().err


def test_netconvert_names_what_is_wrong_with_a_source(copied: Path) -> None:
    edges = copied / "tee-town" / "plain" / "tee-town.edg.xml"
    text = edges.read_text(encoding="utf-8")
    edges.write_text(text.replace('from="market_church"', 'from="nowhere"', 1), "utf-8")
    with pytest.raises(NetworkError, match=r"netconvert failed: .*nowhere"):
        find_outdated_files(copied)


def test_a_missing_netconvert_names_the_extra(
    copied: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # None in sys.modules is how Python marks a package that cannot be imported.
    monkeypatch.setitem(sys.modules, "sumo", None)
    with pytest.raises(NetworkError, match=r"pip install '\.\[networks\]'"):
        find_outdated_files(copied)
