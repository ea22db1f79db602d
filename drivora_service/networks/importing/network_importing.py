"""Importing a road network: SUMO ``.net.xml``, OpenDRIVE ``.xodr`` or OpenStreetMap ``.osm``."""

from __future__ import annotations

import hashlib
import re
from pathlib import Path

from drivora_service.errors import NetworkError, NetworkTaken
from drivora_service.networks.catalogue import is_network_name, shipped_networks
from drivora_service.networks.importing.netconvert import MAX_SECONDS, convert, netconvert_version
from drivora_service.networks.importing.source_checks import check_source
from drivora_service.networks.importing.source_formats import FORMATS, SourceFormat, format_of
from drivora_service.networks.importing.staging import (
    make_taken_error,
    open_stage,
    publish,
    write_synced,
)
from drivora_service.networks.network_loading import load_network
from drivora_service.networks.provenance import FILE_NAME, Provenance

MAX_SOURCE_BYTES = 256 * 1024 * 1024
"""Maximum size of a file, bytes: a whole CARLA town has 1 to 60 MB, a city extract about 100 MB."""

# netconvert's messages if every road was omitted.
_NOTHING_LEFT = re.compile(r"No (nodes|edges) loaded|found no lane")
_NOTHING_LEFT_HINT = " (the file has no road that is open to cars)"


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
        NetworkTaken: Another network has the name.
        NetworkError: The name is not allowed, the file cannot be used, or netconvert is needed and
            missing.
    """
    check_name(name, into, replace=replace)
    form = format_of(source.name)
    data = _read(source, max_bytes)
    target = into / name
    with open_stage(into) as stage:
        made = stage / "new"
        make_network(
            data,
            form,
            name,
            made,
            called=repr(source.name),
            origin=source.name,
            max_seconds=max_seconds,
        )
        publish(made, target, replace=replace)
    return target / f"{name}.net.xml"


def check_name(name: str, into: Path, *, replace: bool) -> None:
    """Checks that a network can be imported under a name.

    Raises:
        NetworkTaken: A shipped network has the name, or an imported one that is not to be replaced.
        NetworkError: The name is not allowed.
    """
    if not is_network_name(name):
        raise NetworkError(
            f"{name[:80]!r} cannot name a network: use 1 to 64 letters, digits, '-' and '_'"
        )
    if (shipped_networks() / name).is_dir():
        raise NetworkTaken(
            f"network {name!r} comes with Drivora; import yours under another name", is_shipped=True
        )
    if not replace and ((into / name).exists() or (into / f"{name}.net.xml").exists()):
        raise make_taken_error(name)


def make_network(
    data: bytes,
    form: SourceFormat,
    name: str,
    folder: Path,
    *,
    called: str,
    origin: str,
    max_seconds: float,
) -> None:
    """Writes the files of a network into a folder.

    Args:
        data: The source.
        form: Its format.
        name: Name of the network.
        folder: Folder of the files; is created, in a folder that is removed after a failure.
        called: Name of the source in messages.
        origin: The same in the provenance.
        max_seconds: A longer conversion is cancelled.

    Raises:
        NetworkError: The source cannot be used, or netconvert is needed and missing.
        OSError: A file cannot be written.
    """
    check_source(data, form, called)
    details = FORMATS[form]
    folder.mkdir()
    path = folder / f"{name}.net.xml"
    try:
        network, version = _convert_source(data, form, folder.parent, max_seconds)
        write_synced(path, network)
        load_network(path, name)
    except NetworkError as error:
        hint = _NOTHING_LEFT_HINT if _NOTHING_LEFT.search(str(error)) else ""
        raise NetworkError(f"cannot import {called}: {error}{hint}") from error
    provenance = Provenance(
        title=name,
        description=f"Imported from {details.label}.",
        source=origin,
        licence=details.licence,
        source_sha256=hashlib.sha256(data).hexdigest(),
        netconvert=version,
        options=details.options,
    )
    write_synced(folder / FILE_NAME, provenance.to_yaml().encode())


def _read(source: Path, max_bytes: int) -> bytes:
    """Reads the file once, so that the checked bytes are the converted ones."""
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
    return data


def _convert_source(
    data: bytes, form: SourceFormat, stage: Path, max_seconds: float
) -> tuple[bytes, str | None]:
    """Returns the network and the version of netconvert, if it was converted."""
    details = FORMATS[form]
    if details.reader is None:
        return data, None
    version = netconvert_version()
    source = stage / "source.xml"
    source.write_bytes(data)
    try:
        arguments = [details.reader, str(source), *details.options]
        network = convert(arguments, timeout=max_seconds)
    finally:
        source.unlink()
    check_source(network, SourceFormat.SUMO, "the converted network")
    return network, version
