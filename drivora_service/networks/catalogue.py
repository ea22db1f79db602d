"""The catalogue of networks: shipped and imported ones."""

from __future__ import annotations

import re
import threading
from pathlib import Path
from typing import Protocol
from weakref import WeakValueDictionary

from drivora_service.errors import UnknownName
from drivora_service.networks.network_loading import load_network
from drivora_service.networks.provenance import FILE_NAME, Provenance, read_provenance
from drivora_service.networks.road_network import RoadNetwork

_NAME = re.compile(r"[A-Za-z0-9_-]{1,64}", re.ASCII)

_SUFFIX = ".net.xml"

_Version = tuple[int, int, int]

# A process has several catalogues, and a worker those that its fork server has left: each reads
# only what no other one has. Networks are read-only.
_in_use: WeakValueDictionary[tuple[Path, _Version], RoadNetwork] = WeakValueDictionary()


def shipped_networks() -> Path:
    """Returns the folder of the shipped networks, in a checkout or in an installed package."""
    package = Path(__file__).resolve().parents[1]
    installed = package / "_data" / "sumo_nets"
    return installed if installed.is_dir() else package.parent / "sumo_nets"


def is_network_name(name: str) -> bool:
    """Returns whether a name consists of at most 64 letters, digits, ``_`` and ``-``."""
    return _NAME.fullmatch(name) is not None


class NetworkLookup(Protocol):
    """Finds road networks by name."""

    def get(self, name: str) -> RoadNetwork:
        """Returns a network.

        Raises:
            UnknownName: There is no such network.
            NetworkError: Its file cannot be used.
        """


class NetworkCatalogue:
    """Networks by name, each read once in a process, also if it has several catalogues.

    A folder of networks holds ``NAME/NAME.net.xml`` (with ``provenance.yaml`` beside it) or
    ``NAME.net.xml``. A shipped network cannot be replaced by an imported one of the same name.
    Networks that are imported while the process runs are found too. It is thread-safe.
    """

    def __init__(self, shipped: Path, imported: Path | None = None) -> None:
        self._folders = (shipped,) if imported is None else (shipped, imported)
        self._networks: dict[str, tuple[_Version, RoadNetwork]] = {}
        self._locks: dict[str, threading.Lock] = {}

    def names(self) -> tuple[str, ...]:
        """Returns all names in alphabetical order."""
        names: set[str] = set()
        for folder in self._folders:
            if folder.is_dir():
                names.update(p.name.removesuffix(_SUFFIX) for p in folder.glob(f"*{_SUFFIX}"))
                names.update(
                    p.name for p in folder.iterdir() if (p / f"{p.name}{_SUFFIX}").is_file()
                )
        return tuple(sorted(filter(is_network_name, names)))

    def path(self, name: str) -> Path:
        """Returns the ``.net.xml`` file of a network.

        Raises:
            UnknownName: There is no such network; a name is never taken as a path.
        """
        if is_network_name(name):
            for folder in self._folders:
                for path in (folder / name / f"{name}{_SUFFIX}", folder / f"{name}{_SUFFIX}"):
                    if path.is_file():
                        return path
        raise UnknownName(
            "network",
            name,
            self.names(),
            hint="Import it with `drivora networks import FILE --name NAME`",
        )

    def get(self, name: str) -> RoadNetwork:
        """Returns a network, read on the first call and again when its file has changed.

        Raises:
            UnknownName: There is no such network.
            NetworkError: Its file cannot be used.
        """
        path = self.path(name)
        version = _version(path)
        # One lock for each network: others are available while a large one is read.
        with self._locks.setdefault(name, threading.Lock()):
            known = self._networks.get(name)
            if known is None or known[0] != version or known[1].path != path:
                network = _in_use.get((path, version))
                if network is None:
                    network = _in_use[path, version] = load_network(path, name)
                known = (version, network)
                self._networks[name] = known
            return known[1]

    def is_current(self, network: RoadNetwork) -> bool:
        """Returns whether a network that this catalogue has read still is what its file holds."""
        known = self._networks.get(network.name)
        if known is None or known[1] is not network:
            return False
        try:
            path = self.path(network.name)
            return path == network.path and _version(path) == known[0]
        except (OSError, UnknownName):
            return False

    def provenance(self, name: str) -> Provenance | None:
        """Returns the provenance of a network; None if no ``provenance.yaml`` is beside it.

        Raises:
            UnknownName: There is no such network.
            NetworkError: The ``provenance.yaml`` cannot be used.
        """
        folder = self.path(name).parent
        if folder.name != name or not (folder / FILE_NAME).is_file():
            return None
        return read_provenance(folder)


def _version(path: Path) -> _Version:
    """Returns what changes with a file: one that replaces another is a file of its own."""
    status = path.stat()
    return status.st_mtime_ns, status.st_size, status.st_ino
