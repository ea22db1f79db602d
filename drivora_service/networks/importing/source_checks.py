"""Checks of network files before any reader of networks gets them.

SUMO's readers do more than read networks. They follow entities, ``<include>`` elements and the
grids of map projections to other files. In a network file they accept every element of a
simulation, among them detectors, vehicles and traffic lights that write files wherever they are
told to. So a file may have only what networks consist of.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from xml.parsers import expat

from drivora_service.errors import NetworkError
from drivora_service.networks.importing.source_formats import FORMATS, SourceFormat

MAX_DEPTH = 100
"""Elements within one another; OpenDRIVE has about ten."""

MAX_PIECE_BYTES = 1 << 20
"""From one tag to the next. Readers that take a file in parts begin a tag, text or comment that is
not complete again with each part, in time that grows with the square of its length."""

_ENCODINGS = frozenset({"utf-8", "utf8", "utf-16", "us-ascii", "iso-8859-1"})
"""Encodings that every XML parser reads in the same way."""

_COMPRESSED = (b"\x1f\x8b", b"PK\x03\x04", b"BZh", b"\xfd7zXZ", b"\x28\xb5\x2f\xfd", b"7z\xbc\xaf")
"""First bytes of gzip, zip, bzip2, xz, zstd and 7z."""

NETWORK_ELEMENTS = frozenset(
    {
        *("net", "location", "type", "restriction", "edge", "lane", "neigh", "stopOffset"),
        *("connection", "conflict", "junction", "request", "roundabout", "prohibition"),
        *("tlLogic", "phase", "param", "taz", "tazSource", "tazSink"),
    }
)
"""Elements of SUMO's ``net_file.xsd``."""

_LIGHT_TYPES = frozenset(
    {"static", "actuated", "delay_based", "NEMA", "off", "rail_signal", "rail_crossing"}
)
"""Types of traffic lights that open files by the parameter ``file`` only."""

_NAMES_A_FILE = re.compile(r"""[=,"'][^\s,"']*/""")
"""A value with a folder in the parameters of a map projection; the name of one may have a slash."""


def check_source(data: bytes, form: SourceFormat, called: str) -> None:
    """Checks a file that is to be imported.

    Args:
        data: Its content.
        form: The format that it is said to have.
        called: Its name in messages.

    Raises:
        NetworkError: It is not well-formed, has another root element, or has what could make a
            reader open other files.
        MemoryError: There is not enough memory for the check.
    """
    if data.startswith(_COMPRESSED):
        raise NetworkError(f"{called} is compressed; unpack it and import the XML file in it")
    try:
        _Check(form, called).parse(data)
    except expat.ExpatError as error:
        if error.code == expat.errors.codes[expat.errors.XML_ERROR_NO_MEMORY]:
            raise MemoryError from error
        raise NetworkError(f"{called} is not well-formed XML: {error}") from error
    except (ValueError, LookupError) as error:
        raise NetworkError(f"{called} is not well-formed XML: {error}") from error


class _Check:
    """The check of one file, element by element."""

    def __init__(self, form: SourceFormat, called: str) -> None:
        self._form, self._called = FORMATS[form], called
        self._is_network = form is SourceFormat.SUMO
        self._depth = 0
        self._place = 0
        self._projection: list[str] = []
        self._parser = expat.ParserCreate()

    def parse(self, data: bytes) -> None:
        """Parses the whole file."""
        parser = self._parser
        parser.XmlDeclHandler = self._declaration
        parser.StartDoctypeDeclHandler = self._document_type
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        parser.Parse(data, True)
        self._advance(len(data))

    def _declaration(self, _version: str, encoding: str | None, _standalone: int) -> None:
        if encoding is not None and encoding.lower() not in _ENCODINGS:
            raise NetworkError(
                f"{self._called} has the encoding {encoding[:40]!r}; allowed are UTF-8, UTF-16, "
                "ISO-8859-1 and US-ASCII: save it as UTF-8"
            )

    def _document_type(self, *_declaration: object) -> None:
        # Only document types declare entities, which can read other files or grow without bound.
        raise NetworkError(
            f"{self._called} has a document type declaration, which is not allowed; remove it"
        )

    def _start(self, tag: str, attributes: Mapping[str, str]) -> None:
        if self._depth == 0 and tag != self._form.root:
            raise NetworkError(
                f"{self._called} is not {self._form.label}: its root element is <{tag[:40]}>, not "
                f"<{self._form.root}>"
            )
        self._advance(self._parser.CurrentByteIndex)
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise NetworkError(
                f"{self._called} has more than {MAX_DEPTH} elements within one another; no network "
                "has so many"
            )
        if tag == "include":
            raise NetworkError(
                f"{self._called} includes another file, which is not allowed; put its content in "
                "the place of <include>"
            )
        if self._is_network:
            self._check_of_network(tag, attributes)
        elif tag == "geoReference":
            self._parser.CharacterDataHandler = self._projection.append

    def _check_of_network(self, tag: str, attributes: Mapping[str, str]) -> None:
        if tag not in NETWORK_ELEMENTS:
            raise NetworkError(
                f"{self._called} has an element <{tag[:40]}>, which is no part of a road network; "
                "remove it, or let netconvert write the network"
            )
        if tag == "location":
            self._check_projection(attributes.get("projParameter", ""))
        if tag == "tlLogic" and attributes.get("type", "static") not in _LIGHT_TYPES:
            raise NetworkError(
                f"{self._called} has a traffic light of the type {attributes['type'][:40]!r}; "
                f"allowed are {', '.join(sorted(_LIGHT_TYPES))}"
            )
        if tag == "param" and attributes.get("key") == "file":
            raise NetworkError(
                f"{self._called} has a parameter 'file', by which SUMO would write a file; remove "
                "it"
            )

    def _check_projection(self, parameters: str) -> None:
        if _NAMES_A_FILE.search(parameters):
            raise NetworkError(
                f"{self._called} has a map projection that names a file: {parameters[:80]!r}; "
                "leave the file out"
            )

    def _advance(self, place: int) -> None:
        if place - self._place > MAX_PIECE_BYTES:
            raise NetworkError(
                f"{self._called} has {(place - self._place) / 1e6:.1f} MB without an element, from "
                f"byte {self._place} on; at most {MAX_PIECE_BYTES / 1e6:.1f} MB are allowed for an "
                "attribute, a text or a comment: shorten it"
            )
        self._place = place

    def _end(self, tag: str) -> None:
        self._advance(self._parser.CurrentByteIndex)
        self._depth -= 1
        if tag == "geoReference" and not self._is_network:
            self._parser.CharacterDataHandler = None
            self._check_projection("".join(self._projection))
