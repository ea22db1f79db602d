"""OpenDRIVE and OpenStreetMap files that are broken, each in one way; made when they are needed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from tests.networks.importing.test_network_importing import OSM

GEOMETRY = '<geometry s="0" x="{x}" y="{y}" hdg="0" length="{length}"><line/></geometry>'
_LANE = (
    '<lane id="{}" type="driving" level="false"><width sOffset="0" a="3.5" b="0" c="0" d="0"/>'
    "</lane>"
)


def road(
    number: str = "1",
    *,
    x: str = "0",
    y: str = "0",
    length: str = "100",
    link: str = "",
    lanes: str = _LANE.format("-1"),
    geometry: str = GEOMETRY,
) -> str:
    """One straight OpenDRIVE road to the east."""
    return (
        f'<road name="" length="{length}" id="{number}" junction="-1"><link>{link}</link>'
        f"<planView>{geometry.format(x=x, y=y, length=length)}</planView>"
        f'<lanes><laneSection s="0"><center><lane id="0" type="none" level="false"/></center>'
        f"<right>{lanes}</right></laneSection></lanes></road>"
    )


def opendrive(*roads: str, reference: str = "+proj=tmerc +lat_0=0 +lon_0=0") -> str:
    """A file of roads."""
    known = f"<geoReference><![CDATA[{reference}]]></geoReference>" if reference else ""
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<OpenDRIVE>'
        f'<header revMajor="1" revMinor="4" name="" version="1.00">{known}</header>'
        f"{''.join(roads)}</OpenDRIVE>"
    )


def _linked(number: str, behind: str) -> str:
    link = (
        f'<predecessor elementType="road" elementId="{behind}" contactPoint="end"/>'
        f'<successor elementType="road" elementId="{behind}" contactPoint="start"/>'
    )
    return road(number, link=link)


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """A file to import.

    Attributes:
        file_name: Its suffix tells the format.
        make: Makes its content.
        is_usable: Whether it becomes a network; ``None`` where it may.
    """

    file_name: str
    make: Callable[[], bytes]
    is_usable: bool | None = False


def _xodr(text: str, *, is_usable: bool | None = False) -> Source:
    return Source(file_name="town.xodr", make=text.encode, is_usable=is_usable)


def _osm(text: str, *, is_usable: bool | None = False) -> Source:
    return Source(file_name="town.osm", make=text.encode, is_usable=is_usable)


_ONE = opendrive(road())
_ARC = '<geometry s="0" x="0" y="0" hdg="0" length="100"><arc curvature="{}"/></geometry>'
_SPIRAL = (
    '<geometry s="0" x="0" y="0" hdg="0" length="100"><spiral curvStart="0" curvEnd="{}"/>'
    "</geometry>"
)
_CUBIC = (
    '<geometry s="0" x="0" y="0" hdg="0" length="100"><paramPoly3 aU="0" bU="{0}" cU="{0}" '
    'dU="0" aV="0" bV="0" cV="{0}" dV="0" pRange="arcLength"/></geometry>'
)
_BOMB = (
    '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa">'
    + "".join(f'<!ENTITY {chr(98 + i)} "{f"&{chr(97 + i)};" * 10}">' for i in range(9))
    + "]>"
)
_EXTERNAL = '<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]>'


def _with_type(text: str, document_type: str) -> str:
    head, _, body = text.partition("?>")
    return f"{head}?>{document_type}{body}"


def _cut(text: str, parts: int) -> Iterator[tuple[int, str]]:
    for part in range(1, parts):
        yield part, text[: part * len(text) // parts]


SOURCES: dict[str, Source] = {
    "one road": _xodr(_ONE, is_usable=True),
    "no geoReference": _xodr(opendrive(road(), reference=""), is_usable=True),
    "odd geoReference": _xodr(opendrive(road(), reference="+proj=none +x_0=z"), is_usable=None),
    "geoReference with a file": _xodr(
        opendrive(road(), reference="+proj=longlat +nadgrids=/etc/passwd"), is_usable=None
    ),
    "empty": _xodr(""),
    "white space": _xodr(" \n"),
    "binary": Source(file_name="town.xodr", make=lambda: bytes(range(256)) * 40),
    "Latin-1 that claims to be UTF-8": Source(
        file_name="town.xodr",
        make=lambda: _ONE.replace('name=""', 'name="Straße"').encode("latin-1"),
    ),
    "UTF-16": Source(
        file_name="town.xodr",
        make=lambda: _ONE.replace("UTF-8", "UTF-16").encode("utf-16"),
        is_usable=None,
    ),
    "unknown encoding": _xodr(_ONE.replace("UTF-8", "klingon")),
    "another format": _xodr(OSM),
    "no road": _xodr(opendrive()),
    "no length": _xodr(opendrive(road(length="0"))),
    "shorter than a millimetre": _xodr(opendrive(road(length="1e-9")), is_usable=None),
    "negative length": _xodr(opendrive(road(length="-100")), is_usable=None),
    "length NaN": _xodr(opendrive(road(length="nan"))),
    "length infinite": _xodr(opendrive(road(length="inf"))),
    "length 1e300": _xodr(opendrive(road(length="1e300"))),
    "x NaN": _xodr(opendrive(road(x="nan"))),
    "x infinite": _xodr(opendrive(road(x="inf"))),
    "x 1e300": _xodr(opendrive(road(x="1e300"))),
    "x 1e7": _xodr(opendrive(road(x="1e7")), is_usable=None),
    "roads 10,000 km apart": _xodr(opendrive(road("1"), road("2", x="1e7", y="1e7"))),
    "length as text": _xodr(opendrive(road(length="long"))),
    "id twice": _xodr(opendrive(road(), road(y="50")), is_usable=None),
    "id empty": _xodr(opendrive(road("")), is_usable=None),
    "id with markup": _xodr(opendrive(road("&lt;a&gt; &quot;b")), is_usable=None),
    "linked to itself": _xodr(opendrive(_linked("1", "1")), is_usable=None),
    "linked in a ring": _xodr(
        opendrive(_linked("1", "2"), _linked("2", "3"), _linked("3", "1")), is_usable=None
    ),
    "linked to nothing": _xodr(opendrive(_linked("1", "9")), is_usable=None),
    "no lane": _xodr(opendrive(road(lanes=""))),
    "no geometry": _xodr(opendrive(road(geometry=""))),
    "lane id twice": _xodr(opendrive(road(lanes=_LANE.format("-1") * 2)), is_usable=None),
    "lane id -999": _xodr(opendrive(road(lanes=_LANE.format("-999"))), is_usable=None),
    "lane id as text": _xodr(opendrive(road(lanes=_LANE.format("x")))),
    "lane width NaN": _xodr(
        opendrive(road(lanes=_LANE.format("-1").replace("3.5", "nan"))), is_usable=None
    ),
    "lane width negative": _xodr(
        opendrive(road(lanes=_LANE.format("-1").replace("3.5", "-3.5"))), is_usable=None
    ),
    "lane width 1e9": _xodr(
        opendrive(road(lanes=_LANE.format("-1").replace("3.5", "1e9"))), is_usable=None
    ),
    "arc of curvature 0": _xodr(opendrive(road(geometry=_ARC.format("0"))), is_usable=None),
    "arc of curvature 1e9": _xodr(opendrive(road(geometry=_ARC.format("1e9"))), is_usable=None),
    "arc of curvature NaN": _xodr(opendrive(road(geometry=_ARC.format("nan"))), is_usable=None),
    "spiral of curvature 1e9": _xodr(
        opendrive(road(geometry=_SPIRAL.format("1e9"))), is_usable=None
    ),
    "spiral of curvature infinite": _xodr(
        opendrive(road(geometry=_SPIRAL.format("inf"))), is_usable=None
    ),
    "cubic of 1e300": _xodr(opendrive(road(geometry=_CUBIC.format("1e300"))), is_usable=None),
    "cubic of NaN": _xodr(opendrive(road(geometry=_CUBIC.format("nan"))), is_usable=None),
    "junction of nothing": _xodr(
        _ONE.replace(
            "</OpenDRIVE>",
            '<junction id="5" name=""><connection id="0" '
            'incomingRoad="8" connectingRoad="9" contactPoint="start"/></junction></OpenDRIVE>',
        ),
        is_usable=None,
    ),
    "2,000 roads": _xodr(
        opendrive(*(road(str(i), y=str(20 * i)) for i in range(2000))), is_usable=True
    ),
    "depth 20,000": _xodr(opendrive("<a>" * 20_000 + "</a>" * 20_000)),
    "attribute of 1 MB": _xodr(
        _ONE.replace('name=""', f'name="{"x" * 1_000_000}"'), is_usable=None
    ),
    "entity bomb": _xodr(_with_type(_ONE, _BOMB).replace('name=""', 'name="&j;"')),
    "external entity": _xodr(_with_type(_ONE, _EXTERNAL).replace("<link>", "<link>&a;")),
    **{f"cut after {part}/7": _xodr(text) for part, text in _cut(_ONE, 7)},
    "OSM": _osm(OSM, is_usable=True),
    "OSM, empty root": _osm("<osm/>"),
    "OSM, nodes only": _osm(OSM[: OSM.index("  <way")] + "</osm>"),
    "OSM, ways of no node": _osm("<osm>" + OSM[OSM.index("  <way") :]),
    "OSM, one node a way": _osm(
        OSM.replace('<nd ref="2"/>', "")
        .replace('<nd ref="3"/>', "")
        .replace('<nd ref="5"/><nd ref="6"/>', "")
    ),
    "OSM, all nodes at a place": _osm(
        OSM.replace("48.0030", "48.0010")
        .replace("48.0015", "48.0010")
        .replace("48.0000", "48.0010")
        .replace("11.0020", "11.0000")
        .replace("11.0040", "11.0000"),
        is_usable=None,
    ),
    "OSM, latitude NaN": _osm(OSM.replace('lat="48.0010" lon="11.0000"', 'lat="nan" lon="11"')),
    "OSM, latitude infinite": _osm(
        OSM.replace('lat="48.0010" lon="11.0000"', 'lat="inf" lon="11"')
    ),
    "OSM, latitude 1000": _osm(
        OSM.replace('lat="48.0010" lon="11.0000"', 'lat="1000" lon="11"'), is_usable=None
    ),
    "OSM, pole": _osm(
        OSM.replace('lat="48.0010" lon="11.0000"', 'lat="90" lon="11"'), is_usable=None
    ),
    "OSM, other side of the Earth": _osm(
        OSM.replace('lat="48.0010" lon="11.0000"', 'lat="-48" lon="-169"'), is_usable=None
    ),
    "OSM, latitude as text": _osm(OSM.replace('lat="48.0010" lon="11.0000"', 'lat="n" lon="e"')),
    "OSM, no id": _osm(OSM.replace('<way id="10"', "<way"), is_usable=None),
    "OSM, id twice": _osm(OSM.replace('<way id="11"', '<way id="10"'), is_usable=None),
    "OSM, node id twice": _osm(OSM.replace('<node id="3"', '<node id="1"'), is_usable=None),
    "OSM, id beyond 64 bits": _osm(OSM.replace('id="10"', f'id="{"9" * 30}"'), is_usable=None),
    "OSM, way of one node over and over": _osm(
        OSM.replace('<nd ref="1"/>', '<nd ref="1"/><nd ref="2"/>' * 300), is_usable=None
    ),
    "OSM, a million lanes": _osm(OSM.replace('v="4"', 'v="1000000"'), is_usable=None),
    "OSM, minus one lane": _osm(OSM.replace('v="4"', 'v="-1"'), is_usable=None),
    "OSM, speed NaN": _osm(OSM.replace('v="50"', 'v="nan"'), is_usable=None),
    "OSM, speed 0": _osm(OSM.replace('v="50"', 'v="0"'), is_usable=None),
    "OSM, speed 1e300": _osm(OSM.replace('v="50"', 'v="1e300"'), is_usable=None),
    "OSM, entity bomb": _osm(_with_type(OSM, _BOMB).replace("Long Street", "&j;")),
    "OSM, external entity": _osm(_with_type(OSM, _EXTERNAL).replace("Long Street", "&a;")),
    "OSM, another format": _osm(_ONE),
    **{f"OSM, cut after {part}/7": _osm(text) for part, text in _cut(OSM, 7)},
}
"""By what is wrong with them."""
