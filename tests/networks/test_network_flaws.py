"""Networks that are well-formed and yet no networks."""

from __future__ import annotations

import gzip
from collections.abc import Callable
from pathlib import Path

import pytest

from drivora_service.errors import NetworkError
from drivora_service.networks.network_loading import load_network

Change = Callable[[str], str]


def put(old: str, new: str) -> Change:
    """A change of a text that has ``old`` in it."""

    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new, 1)

    return change


WRONG: dict[str, tuple[Change, str]] = {
    "NaN": (
        put("100.00,0.00 110.00", "100.00,nan 110.00"),
        "found nan in the shape of lane ':n1_0",
    ),
    "infinity": (put("260.00,60.00 -20", "inf,60.00 -20"), "found inf in the shape of lane 'd_0'"),
    "height": (put("0.00,0.00 100.00,0.00", "0,0,nan 100,0,0"), "found nan in the shape of lane"),
    "1e300": (put("260.00,60.00 -20", "1e300,60 -20"), "found 1e.300 in the shape of lane 'd_0'"),
    "half the Earth": (put("250.00,-40.00", "2e7,9e6"), "at most 2500 km² are allowed: cut out"),
    "no shape": (put('shape="0.00,0.00 100.00,0.00"', 'shape=""'), "lane 'a_1' has no shape"),
    "length": (put('length="95.00"', 'length="-1"'), "lane 'a_0' has a length of -1; more than 0"),
    "width": (put('width="2.00"', 'width="0"'), "has a width of 0; more than 0 and at most 100"),
    "speed": (put('speed="15.00"', 'speed="nan"'), "lane 'a_1' has a speed of nan"),
    "location": (put("5.00,-7.50", "5.00,inf"), "found inf in the location"),
    "junction": (put("100.00,4.80", "nan,4.80"), "found nan in the shape of junction 'n1'"),
    "phase": (put('duration="30"', 'duration="inf"'), "found inf in traffic light 'n1'"),
    "no time": (put('duration="1"', 'duration="0"'), ""),
    "phases": (put('state="yr"', 'state="y"'), "phases for different numbers of signals"),
    "signal": (
        put('linkIndex="1"', 'linkIndex="2"'),
        "signal 2 of traffic light 'n1', which has 2",
    ),
    "unknown light": (put('tl="n1"', 'tl="n9"'), "traffic light 'n9', which has 0"),
    "entity": (
        put("<net", '<!DOCTYPE net [<!ENTITY a SYSTEM "/etc/passwd">]><net'),
        "document type",
    ),
    "overflow": (put('linkIndex="1"', 'linkIndex="1e999"'), "not a SUMO network"),
}


@pytest.mark.parametrize("name", WRONG)
def test_flaws_are_refused_with_their_place(name: str, loop_file: Path, tmp_path: Path) -> None:
    change, says = WRONG[name]
    path = tmp_path / "wrong.net.xml"
    path.write_text(change(loop_file.read_text()))
    if says:
        with pytest.raises(NetworkError, match=says):
            load_network(path, "wrong")
    else:
        # SUMO runs the last programme of a light: the one before it may be what it likes.
        load_network(path, "wrong")


def test_a_junction_that_only_edges_name_has_no_shape(loop_file: Path, tmp_path: Path) -> None:
    path = tmp_path / "no-junction.net.xml"
    text = loop_file.read_text()
    begin = text.index('  <junction id="n4"')
    path.write_text(text[:begin] + text[text.index("  <connection") :])
    network = load_network(path, "no-junction")
    assert set(network.junction_shapes) == {"n1", "n2"}


def test_what_is_read_is_what_is_hashed(loop_file: Path, tmp_path: Path) -> None:
    path = tmp_path / "packed.net.xml"
    path.write_bytes(gzip.compress(loop_file.read_bytes()))
    with pytest.raises(NetworkError, match="not well-formed XML"):
        load_network(path, "packed")
