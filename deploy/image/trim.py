"""Prepares an environment for an image: removes what Drivora does not use of its packages.

Run by the Python of the environment, with ``strip`` of binutils::

    /opt/drivora/bin/python deploy/image/trim.py
"""

from __future__ import annotations

import filecmp
import os
import platform
import re
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Iterable
from pathlib import Path

_UNUSED = (
    # Of Arrow: transport of tables over the network, and what compilers need.
    *("pyarrow/libarrow_flight*", "pyarrow/libarrow_python_flight*", "pyarrow/_flight*"),
    *("pyarrow/include", "pyarrow/src"),
    # Of SUMO: shapes, pictures and translations of its windows.
    *("sumo_data/data/3D", "sumo_data/data/po", "sumo_data/data/locale", "sumo_data/data/logo"),
    # And corrections of the coordinates of single countries: networks have UTM or none.
    *("sumo_data/data/proj/*.gsb", "sumo_data/data/proj/*.gtx"),
    # Comes with environments of older versions of Python.
    *("setuptools", "setuptools-*", "_distutils_hack", "pkg_resources", "distutils-precedence.pth"),
    "matplotlib/mpl-data/sample_data",
)
_OF_TESTS = re.compile(r"test_.*\.py|data")
"""Modules and data of tests. Other files of their folders are imported by some packages."""
_SOURCES = {".a", ".c", ".cpp", ".exe", ".h", ".hpp", ".obj", ".pxd", ".pyx"}
"""Files of compilers, and of other systems."""
_RETURN_NOTHING = {"x86_64": "xor %eax, %eax\n ret", "aarch64": "mov x0, xzr\n ret"}
"""Instructions of a function that returns 0, NULL or false, by kind of processor."""
_EPOCH_S = 1_600_000_000


def main() -> int:
    """Trims the environment that runs this; returns the exit code."""
    packages = Path(sysconfig.get_path("purelib"))
    before = _size_mb(packages)
    loadable = _loadable(_libraries(packages))
    for pattern in _UNUSED:
        for path in sorted(packages.glob(pattern)):
            _remove(path)
    for folder in sorted(packages.rglob("tests")):
        if folder.is_dir() and folder.relative_to(packages).parts[0] != "drivora_service":
            for path in sorted(folder.rglob("*"), reverse=True):
                if _OF_TESTS.fullmatch(path.name):
                    _remove(path)
    for path in sorted(packages.rglob("*")):
        if path.suffix in _SOURCES and path.is_file():
            path.unlink()
        elif path.name == "__pycache__":
            _remove(path)
    _link_same(packages)
    _replace_gdal(packages)
    _strip(packages)
    # Whole seconds: a registry keeps no fraction of them, and a module whose file has another time
    # than when it was compiled would be compiled again.
    for path in (packages, *packages.rglob("*")):
        os.utime(path, (_EPOCH_S, _EPOCH_S), follow_symlinks=False)
    broken = loadable & set(_libraries(packages)) - _loadable(_libraries(packages))
    for path in sorted(broken):
        print(f"{path} cannot be loaded any more", file=sys.stderr)
    print(f"trimmed from {before:.0f} MB to {_size_mb(packages):.0f} MB")
    return 1 if broken else 0


def _libraries(packages: Path) -> list[Path]:
    return [
        path
        for path in sorted(packages.rglob("*.so*"))
        if path.is_file() and not path.is_symlink() and path.read_bytes()[:4] == b"\x7fELF"
    ]


def _loadable(libraries: Iterable[Path]) -> set[Path]:
    """Returns the libraries that can be loaded, in a process for each folder of them."""
    found: set[Path] = set()
    of_folders: dict[Path, list[Path]] = {}
    for path in libraries:
        of_folders.setdefault(path.parent, []).append(path)
    script = (
        "import ctypes, os, sys\n"
        "for name in sys.argv[1:]:\n"
        "    try: ctypes.CDLL(name, mode=os.RTLD_LAZY)\n"
        "    except OSError: continue\n"
        "    print(name, flush=True)\n"
        # Without the end of modules that were never begun.
        "os._exit(0)\n"
    )
    for of_folder in of_folders.values():
        command = [sys.executable, "-c", script, *map(str, of_folder)]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
        found |= {Path(name) for name in done.stdout.splitlines()}
    return found


def _strip(packages: Path) -> None:
    """Removes the names of internal functions from libraries, where these can be loaded then.

    Some that were changed when their wheel was made cannot. Libraries that a wheel brought for its
    modules are stripped already.
    """
    stripped = {}
    for path in _libraries(packages):
        if not path.relative_to(packages).parts[0].endswith(".libs"):
            smaller = path.with_name(f"{path.name}.stripped")
            subprocess.run(["strip", "--strip-unneeded", "-o", smaller, path], check=True)
            stripped[smaller] = path
    loadable = _loadable(stripped)
    for smaller, path in stripped.items():
        if smaller in loadable:
            shutil.copymode(path, smaller)
            smaller.replace(path)
        else:
            smaller.unlink()


def _link_same(packages: Path) -> None:
    """Keeps one file of the three that Arrow has of a library, and links the others to it."""
    arrow = sorted(packages.glob("pyarrow/libarrow_python*.so*"), key=lambda path: len(str(path)))
    same = []
    for number, path in enumerate(arrow):
        first = next(one for one in arrow[: number + 1] if filecmp.cmp(one, path, shallow=False))
        if first != path:
            same.append((first, path))
    for first, other in same:
        other.unlink()
        other.symlink_to(first.name)


def _replace_gdal(packages: Path) -> None:
    """Replaces the library GDAL, with all that only it needs, by one that opens no file.

    SUMO reads height maps and shapefiles by it, when it converts networks and polygons. libsumo
    links the same code, but simulates finished networks.
    """
    libraries = packages / "libsumo.libs"
    (gdal,) = libraries.glob("libgdal-*.so*")
    (module,) = packages.glob("libsumo/_libsumo*.so")
    instructions = _RETURN_NOTHING.get(platform.machine())
    if instructions is None:
        return
    # Its own only: it also has parts of the standard library, which others have, too.
    shared = _symbols(module, "--undefined-only") & _symbols(gdal, "--defined-only")
    functions = sorted(name for name in shared if re.match(r"GDAL|_ZN\d+GDAL", name))
    assembly = "".join(
        f".globl {name}\n.type {name}, %function\n{name}:\n {instructions}\n" for name in functions
    )
    made = gdal.with_suffix(".o")
    assemble = ["as", "-o", str(made), "-"]
    subprocess.run(assemble, input=f".text\n{assembly}", text=True, check=True)
    link = ["ld", "-shared", "-z", "noexecstack", "-soname", gdal.name, "-o", str(gdal), str(made)]
    gdal.unlink()
    subprocess.run(link, check=True)
    made.unlink()
    needed: set[str] = set()
    waiting = [module]
    while waiting:
        for name in _needed_by(waiting.pop()) - needed:
            needed.add(name)
            if (libraries / name).is_file():
                waiting.append(libraries / name)
    for path in libraries.iterdir():
        if path.name not in needed:
            path.unlink()
    # All its functions are found, not only those that are called.
    command = [sys.executable, "-c", "import libsumo"]
    subprocess.run(command, env={**os.environ, "LD_BIND_NOW": "1"}, check=True)


def _symbols(library: Path, which: str) -> set[str]:
    command = ["nm", "--dynamic", "--format=just-symbols", which, str(library)]
    printed = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
    return {line.split("@")[0] for line in printed.splitlines()}


def _needed_by(library: Path) -> set[str]:
    command = ["readelf", "--dynamic", str(library)]
    printed = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
    return set(re.findall(r"\(NEEDED\).*\[(.+)\]", printed))


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _size_mb(folder: Path) -> float:
    files = (path for path in folder.rglob("*") if path.is_file() and not path.is_symlink())
    return sum(path.stat().st_size for path in files) / 1e6


if __name__ == "__main__":
    sys.exit(main())
