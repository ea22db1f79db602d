"""What a network file must not have, and why: SUMO's readers act on it."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from drivora_service.errors import NetworkError
from drivora_service.networks.importing import source_checks
from drivora_service.networks.importing.source_checks import MAX_DEPTH, check_source
from drivora_service.networks.importing.source_formats import SourceFormat
from tests.networks.broken_sources import opendrive, road

SUMO, XODR, OSM = SourceFormat


def net(content: str = "", *, encoding: str = "UTF-8") -> bytes:
    return f'<?xml version="1.0" encoding="{encoding}"?>\n<net>{content}</net>'.encode()


def deep(levels: int) -> bytes:
    return net("<edge>" * (levels - 1) + "</edge>" * (levels - 1))


INCLUDE = '<include href="/etc/hostname" file="/etc/hostname"/>'
DETECTOR = '<inductionLoop id="x" lane="a_0" pos="1" freq="1" file="/tmp/x"/>'
LIGHT = '<tlLogic id="x" type="{}" programID="0" offset="0">{}</tlLogic>'
LONG = "x" * 1_100_000
WRITES = '<param key="file" value="/tmp/x"/>'


@pytest.mark.parametrize(
    ("form", "data", "says"),
    [
        (SUMO, net(INCLUDE), "includes another file"),
        (XODR, f"<OpenDRIVE>{INCLUDE}</OpenDRIVE>".encode(), "includes another file"),
        (OSM, f"<osm>{INCLUDE}</osm>".encode(), "includes another file"),
        (SUMO, net(DETECTOR), "an element <inductionLoop>, which is no part of a road network"),
        (SUMO, net('<edgeData id="x" file="/tmp/x"/>'), "an element <edgeData>"),
        (SUMO, net('<vehicle id="x" depart="0"/>'), "an element <vehicle>"),
        (SUMO, net(LIGHT.format("delay_based", WRITES)), "parameter 'file'"),
        (SUMO, net(LIGHT.format("swarm", "")), "traffic light of the type 'swarm'; allowed are"),
        (SUMO, net('<location projParameter="+proj=utm +nadgrids=/tmp/x"/>'), "names a file"),
        (SUMO, net('<location projParameter="+init=../x:1"/>'), "names a file"),
        (XODR, opendrive(reference="+proj=utm +nadgrids=@null,/tmp/x").encode(), "names a file"),
        (SUMO, net(encoding="cp037"), "encoding 'cp037'; allowed are UTF-8, UTF-16"),
        (SUMO, net(encoding="UTF-7"), "encoding 'UTF-7'"),
        (SUMO, deep(MAX_DEPTH + 1), "more than 100 elements within one another"),
        (SUMO, net(f'<edge id="{LONG}"/>'), "has 1.1 MB without an element, from byte 44 on"),
        (SUMO, net(f"<!--{LONG}-->"), "has 1.1 MB without an element"),
        (XODR, f"<OpenDRIVE>{LONG}</OpenDRIVE>".encode(), "has 1.1 MB without an element"),
        (OSM, f"<osm/><!--{LONG}-->".encode(), "has 1.1 MB without an element"),
        (SUMO, b"\x1f\x8b\x08", "is compressed; unpack it"),
        (SUMO, b"PK\x03\x04", "is compressed; unpack it"),
        (SUMO, b"<osm/>", "root element is <osm>, not <net>"),
        (SUMO, b"\x00\x01\x02", "not well-formed XML"),
    ],
)
def test_refused(form: SourceFormat, data: bytes, says: str) -> None:
    with pytest.raises(NetworkError, match=re.escape(says)):
        check_source(data, form, "the file")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "iso-8859-1", "us-ascii"])
def test_document_types_are_found_in_every_encoding(encoding: str) -> None:
    text = f'<?xml version="1.0" encoding="{encoding}"?><!DOCTYPE net [<!ENTITY a "b">]><net/>'
    with pytest.raises(NetworkError, match="document type declaration"):
        check_source(text.encode(encoding), SUMO, "the file")
    without = re.sub(r"<!DOCTYPE.*?\]>", "", text)
    check_source(without.encode(encoding), SUMO, "the file")


@pytest.mark.parametrize(
    "projection",
    [
        "!",
        "+proj=utm +zone=32 +ellps=WGS84 +nadgrids=@null +units=m",
        "+proj=tmerc +geoidgrids=egm96_15.gtx +vunits=m",
        'PROJCS["WGS 84 / UTM zone 32N",GEOGCS["WGS 84"]]',
    ],
)
def test_projections_without_a_file(projection: str) -> None:
    attribute = projection.replace('"', "&quot;")
    check_source(net(f'<location projParameter="{attribute}"/>'), SUMO, "the file")
    check_source(opendrive(reference=projection).encode(), XODR, "the file")


def test_elements_within_one_another_up_to_the_limit() -> None:
    check_source(deep(MAX_DEPTH), SUMO, "the file")


def test_real_networks_pass(repository: Path) -> None:
    for path in repository.glob("sumo_nets/*/*.net.xml"):
        check_source(path.read_bytes(), SUMO, path.name)


def test_the_allowed_elements_are_those_of_sumos_schema() -> None:
    """No other is allowed, and none that networks need is missing."""
    sumo = pytest.importorskip("sumo")
    folder = Path(sumo.__path__[0]) / "data" / "xsd"
    own = _elements(folder / "net_file.xsd")
    base = _elements(folder / "types" / "base.xsd") | _elements(folder / "types" / "taz.xsd")
    assert own <= source_checks.NETWORK_ELEMENTS
    assert own | base >= source_checks.NETWORK_ELEMENTS


def _elements(schema: Path) -> set[str]:
    return set(re.findall(r'<xsd:element name="(\w+)"', schema.read_text()))


RUN = """
import libsumo, sys
libsumo.start(["sumo", "--net-file", sys.argv[1], "--no-step-log", "true"])
libsumo.simulationStep()
"""


def test_sumo_writes_where_a_network_tells_it_to(repository: Path, tmp_path: Path) -> None:
    """Else the check of elements would have no reason."""
    text = (repository / "sumo_nets" / "tee-town" / "tee-town.net.xml").read_text()
    written = tmp_path / "written.xml"
    network = tmp_path / "town.net.xml"
    network.write_text(
        text.replace("</net>", f'<edgeData id="x" freq="1" file="{written}"/></net>')
    )
    subprocess.run([sys.executable, "-c", RUN, network], check=False, capture_output=True)
    assert written.exists()
    with pytest.raises(NetworkError, match="<edgeData>"):
        check_source(network.read_bytes(), SUMO, "the file")


def test_netconvert_reads_what_a_file_includes(tmp_path: Path) -> None:
    """Else the check of includes would have no reason."""
    sumo = pytest.importorskip("sumo")
    (tmp_path / "included.xml").write_text("no XML")
    source = tmp_path / "town.xodr"
    source.write_text(opendrive(road()).replace("</Open", '<include file="included.xml"/></Open'))
    program = Path(sumo.__path__[0]) / "bin" / "netconvert"
    command = [str(program), "--opendrive-files", str(source), "--output-file", "out"]
    done = subprocess.run(command, check=False, capture_output=True, text=True, cwd=tmp_path)
    assert "included.xml" in done.stdout + done.stderr
