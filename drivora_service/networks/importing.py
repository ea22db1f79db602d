"""Importing a road network: SUMO ``.net.xml``, OpenDRIVE ``.xodr`` or OpenStreetMap ``.osm``."""

from __future__ import annotations

import hashlib
import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from xml.parsers import expat

from drivora_service.errors import NetworkError
from drivora_service.networks.catalogue import is_network_name, shipped_networks
from drivora_service.networks.loading import load_network
from drivora_service.networks.netconvert import MAX_SECONDS, convert, netconvert_version
from drivora_service.networks.provenance import FILE_NAME, Provenance

MAX_SOURCE_BYTES = 256 * 1024 * 1024
"""Maximum size of a file, bytes: a whole CARLA town has 1 to 60 MB, a city extract about 100 MB."""

# netconvert's messages if every road was omitted.
_NOTHING_LEFT = re.compile(r"No (nodes|edges) loaded|found no lane")
_NOTHING_LEFT_HINT = " (the file has no road that is open to cars)"

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


@dataclass(frozen=True, slots=True, kw_only=True)
class _Format:
    """A format of source files.

    Attributes:
        root: Name of the document's root element.
        label: Name in messages.
        reader: netconvert's option for reading it; None if the file is copied.
        options: Further options of netconvert.
        licence: Licence of such files, as far as known.
    """

    root: str
    label: str
    reader: str | None
    options: tuple[str, ...] = ()
    licence: str = "that of the imported file"


_SUMO = _Format(root="net", label="a SUMO network", reader=None)
_XODR = _Format(root="OpenDRIVE", label="OpenDRIVE", reader="--opendrive-files", options=_OPENDRIVE)
_OSM = _Format(
    root="osm",
    label="OpenStreetMap",
    reader="--osm-files",
    options=_OPENSTREETMAP,
    licence="ODbL-1.0, © OpenStreetMap contributors",
)
_FORMATS = {".net.xml": _SUMO, ".xodr": _XODR, ".osm": _OSM, ".osm.xml": _OSM}


def import_network(
    source: Path,
    name: str,
    into: Path,
    *,
    replace: bool = False,
    max_bytes: int = MAX_SOURCE_BYTES,
    max_seconds: float = MAX_SECONDS,
) -> Path:
    """Imports a road network under a name.

    The import is atomic. Coordinates of the source become SUMO's by adding the
    network's ``net_offset``.

    Args:
        source: A ``.net.xml``, ``.xodr``, ``.osm`` or ``.osm.xml`` file.
        name: Name of the network: letters, digits, ``-`` and ``_``.
        into: Directory of the imported networks; created if missing.
        replace: Replace an imported network of the same name.
        max_bytes: Larger files are rejected.
        max_seconds: A longer conversion is cancelled.

    Returns:
        ``into/<name>/<name>.net.xml``; ``provenance.yaml`` is beside it.

    Raises:
        NetworkError: The name is not allowed or taken, the file cannot be used, or netconvert is
            needed and missing.
    """
    if not is_network_name(name):
        raise NetworkError(
            f"{name[:80]!r} cannot name a network: use 1 to 64 letters, digits, '-' and '_'"
        )
    if (shipped_networks() / name).is_dir():
        raise NetworkError(f"network {name!r} comes with Drivora; import yours under another name")
    target = into / name
    if target.exists() and not replace:
        raise NetworkError(
            f"a network {name!r} is already imported; replace it or use another name"
        )
    data, form = _read(source, max_bytes)
    with _staging(into) as stage:
        path = stage / f"{name}.net.xml"
        try:
            network, version = _network_bytes(data, form, stage, max_seconds)
            path.write_bytes(network)
            load_network(path, name)
        except NetworkError as error:
            hint = _NOTHING_LEFT_HINT if _NOTHING_LEFT.search(str(error)) else ""
            raise NetworkError(f"cannot import {source.name!r}: {error}{hint}") from error
        provenance = Provenance(
            title=name,
            description=f"Imported from {form.label}.",
            source=source.name,
            licence=form.licence,
            source_sha256=hashlib.sha256(data).hexdigest(),
            netconvert=version,
            options=form.options,
        )
        (stage / FILE_NAME).write_text(provenance.to_yaml(), encoding="utf-8")
        _publish(stage, target, replace=replace)
    return target / f"{name}.net.xml"


def _read(source: Path, max_bytes: int) -> tuple[bytes, _Format]:
    """Reads the file once, so that the checked bytes are the converted ones."""
    suffix = next((s for s in _FORMATS if source.name.lower().endswith(s)), None)
    if suffix is None:
        raise NetworkError(f"cannot import {source.name!r}: allowed are {', '.join(_FORMATS)}")
    form = _FORMATS[suffix]
    try:
        with source.open("rb") as file:
            data = file.read(max_bytes + 1)
    except OSError as error:
        raise NetworkError(f"cannot read {source.name!r}: {error.strerror}") from error
    if len(data) > max_bytes:
        raise NetworkError(
            f"{source.name!r} is too large: more than {max_bytes / 1e6:.0f} MB; cut out the part "
            "that is needed"
        )
    root = _root_element(data, source.name)
    if root != form.root:
        raise NetworkError(
            f"{source.name!r} is not {form.label}: its root element is <{root}>, not <{form.root}>"
        )
    return data, form


def _root_element(data: bytes, file_name: str) -> str:
    """Returns the root element's name of a well-formed document without a document type."""
    roots: list[str] = []

    def start(tag: str, _attributes: dict[str, str]) -> None:
        if not roots:
            roots.append(tag)

    def refuse(*_declaration: object) -> None:
        # Only document types declare entities, which can read other files or grow without bound.
        raise NetworkError(f"{file_name!r} has a document type declaration, which is not allowed")

    parser = expat.ParserCreate()
    parser.StartElementHandler = start
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(data, True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        raise NetworkError(f"{file_name!r} is not well-formed XML: {error}") from error
    return roots[0]


def _network_bytes(
    data: bytes, form: _Format, stage: Path, max_seconds: float
) -> tuple[bytes, str | None]:
    """Returns the network and the version of netconvert, if it was converted."""
    if form.reader is None:
        return data, None
    version = netconvert_version()
    source = stage / "source.xml"
    source.write_bytes(data)
    try:
        arguments = [form.reader, str(source), *form.options]
        return convert(arguments, timeout=max_seconds), version
    finally:
        source.unlink()


@contextmanager
def _staging(into: Path) -> Iterator[Path]:
    """Provides a directory beside the final one, which is removed afterwards."""
    try:
        into.mkdir(parents=True, exist_ok=True)
        # A network's name cannot begin with a dot, so no catalogue lists it.
        stage = Path(tempfile.mkdtemp(prefix=".importing-", dir=into))
    except OSError as error:
        raise NetworkError(f"cannot write to {into}: {error.strerror}") from error
    try:
        yield stage
    except OSError as error:
        raise NetworkError(f"cannot write the imported network: {error.strerror}") from error
    finally:
        shutil.rmtree(stage, ignore_errors=True)


def _publish(stage: Path, target: Path, *, replace: bool) -> None:
    new = stage / "new"
    new.mkdir()
    for file in [path for path in stage.iterdir() if path.is_file()]:
        file.rename(new / file.name)
    if replace and target.exists():
        target.rename(stage / "old")
    try:
        new.rename(target)
    except OSError as error:
        if (stage / "old").exists():
            (stage / "old").rename(target)
        raise NetworkError(f"a network {target.name!r} appeared meanwhile") from error
