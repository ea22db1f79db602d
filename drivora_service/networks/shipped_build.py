"""Rebuilds the shipped networks from their plain-XML sources.

``python -m drivora_service.networks.shipped_build`` writes them, ``--check`` only lists the ones
that differ. The result is byte-identical on every machine with the same netconvert.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from drivora_service.errors import NetworkError
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.networks.importing.netconvert import convert, netconvert_version
from drivora_service.networks.provenance import FILE_NAME, read_provenance


def sources(networks: Path) -> tuple[Path, ...]:
    """Returns the directories below ``networks`` that hold plain sources, by name."""
    return tuple(sorted(path.parent for path in networks.glob("*/plain") if path.is_dir()))


def build_files(directory: Path) -> Mapping[Path, bytes]:
    """Builds one network in memory.

    Args:
        directory: ``sumo_nets/<name>`` with ``plain/<name>.netccfg`` and ``provenance.yaml``.

    Returns:
        The contents of the network file and of the provenance.

    Raises:
        NetworkError: netconvert is missing or rejects the sources.
    """
    name = directory.name
    configuration = directory / "plain" / f"{name}.netccfg"
    if not configuration.is_file():
        raise NetworkError(f"network {name!r} has no plain/{name}.netccfg")
    provenance = read_provenance(directory).model_copy(update={"netconvert": netconvert_version()})
    return {
        directory / f"{name}.net.xml": convert(["--configuration-file", str(configuration)]),
        directory / FILE_NAME: provenance.to_yaml().encode(),
    }


def find_outdated_files(networks: Path) -> tuple[str, ...]:
    """Returns the files below ``networks`` that a rebuild would change, as relative paths.

    Raises:
        NetworkError: netconvert is missing or rejects the sources.
    """
    return tuple(
        path.relative_to(networks).as_posix()
        for directory in sources(networks)
        for path, content in build_files(directory).items()
        if not path.is_file() or path.read_bytes() != content
    )


def rebuild(networks: Path) -> tuple[str, ...]:
    """Rebuilds every network below ``networks`` and returns the files that changed.

    Raises:
        NetworkError: netconvert is missing or rejects the sources.
    """
    changed = []
    for directory in sources(networks):
        for path, content in build_files(directory).items():
            if not path.is_file() or path.read_bytes() != content:
                path.write_bytes(content)
                changed.append(path.relative_to(networks).as_posix())
    return tuple(changed)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m drivora_service.networks.shipped_build",
        description="Rebuild the shipped networks from their plain sources (needs netconvert).",
    )
    parser.add_argument(
        "--check", action="store_true", help="change nothing; exit 1 on differences"
    )
    parser.add_argument(
        "--networks",
        type=Path,
        default=shipped_networks(),
        help="directory of the networks (default: the shipped ones)",
    )
    options = parser.parse_args(arguments)
    networks: Path = options.networks
    try:
        if not sources(networks):
            raise NetworkError(f"no network with plain sources in {networks}")
        files = find_outdated_files(networks) if options.check else rebuild(networks)
    except NetworkError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    for file in files:
        print(f"{'differs' if options.check else 'rebuilt'}: {file}")
    print(f"{len(sources(networks))} networks, {len(files)} files changed")
    return 1 if options.check and files else 0


if __name__ == "__main__":
    sys.exit(main())
