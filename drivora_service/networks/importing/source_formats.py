"""The formats of files that road networks are imported from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from drivora_service.errors import NetworkError


class SourceFormat(StrEnum):
    """A format of source files."""

    SUMO = "sumo"
    OPENDRIVE = "opendrive"
    OPENSTREETMAP = "openstreetmap"


@dataclass(frozen=True, slots=True, kw_only=True)
class FormatDetails:
    """Details of a format.

    Attributes:
        suffixes: Endings of the names of such files.
        root: Name of the document's root element.
        label: Name in messages.
        reader: netconvert's option for reading it; None if the file is copied.
        options: Further options of netconvert.
        licence: Licence of such files, as far as known.
    """

    suffixes: tuple[str, ...]
    root: str
    label: str
    reader: str | None = None
    options: tuple[str, ...] = ()
    licence: str = "that of the imported file"


# No schema is fetched for validation, and no U-turns are added on open roads.
_COMMON = ("--xml-validation", "never", "--no-turnarounds.except-deadend", "true")

# The lanes of CARLA's towns keep the ids and places of other conversions of the towns.
# Smaller steps than the default keep tight bends round.
_OPENDRIVE = (*_COMMON, "--opendrive.curve-resolution", "1")

# SUMO's recommendations for OpenStreetMap, for roads open to cars; sidewalks become lanes of them.
_OPENSTREETMAP = (
    *_COMMON,
    *("--keep-edges.by-vclass", "passenger"),
    *("--remove-edges.isolated", "true"),
    *("--geometry.remove", "true"),
    *("--junctions.join", "true"),
    *("--junctions.corner-detail", "5"),
    *("--ramps.guess", "true"),
    *("--roundabouts.guess", "true"),
    *("--tls.guess-signals", "true"),
    *("--tls.discard-simple", "true"),
    *("--tls.join", "true"),
    *("--tls.default-type", "static"),
    *("--osm.turn-lanes", "true"),
    *("--osm.sidewalks", "true"),
    *("--crossings.guess", "true"),
    *("--output.street-names", "true"),
)

FORMATS: Mapping[SourceFormat, FormatDetails] = {
    SourceFormat.SUMO: FormatDetails(
        suffixes=(".net.xml",),
        root="net",
        label="a SUMO network",
    ),
    SourceFormat.OPENDRIVE: FormatDetails(
        suffixes=(".xodr",),
        root="OpenDRIVE",
        label="OpenDRIVE",
        reader="--opendrive-files",
        options=_OPENDRIVE,
    ),
    SourceFormat.OPENSTREETMAP: FormatDetails(
        suffixes=(".osm", ".osm.xml"),
        root="osm",
        label="OpenStreetMap",
        reader="--osm-files",
        options=_OPENSTREETMAP,
        licence="ODbL-1.0, © OpenStreetMap contributors",
    ),
}


def format_of(file_name: str) -> SourceFormat:
    """Returns the format of a file by its name.

    Raises:
        NetworkError: The name has none of the endings.
    """
    for form, details in FORMATS.items():
        if file_name.lower().endswith(details.suffixes):
            return form
    endings = ", ".join(suffix for details in FORMATS.values() for suffix in details.suffixes)
    raise NetworkError(f"cannot import {file_name!r}: allowed are {endings}")
