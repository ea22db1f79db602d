"""Checks of the software: versions, packages, what shadows what, system libraries, the page."""

from __future__ import annotations

import os
import platform
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

from drivora_service import system_libraries
from drivora_service.cli.doctor.findings import Check, Finding, noted, ok, problem

PACKAGE = Path(__file__).resolve().parents[2]
"""Folder of the package that is checked."""

CHILD_S = 60.0
"""Seconds within which a child process of a check must end."""

_AGAIN = (
    "Install again: `make install` in a checkout (remove .venv first if that does not help), else "
    "`pip install --force-reinstall` with the file of the wheel"
)
_PIN = re.compile(r"^([A-Za-z0-9._-]+)==([^\s;\\]+)\s*(?:;\s*([^\\]*))?")


def check_version() -> Iterator[Finding]:
    """Checks Drivora, and whether the package in use is the installed one."""
    found = [*metadata.distributions(name="drivora")]
    if not found:
        yield problem("Drivora", f"no installed package; its code is in {PACKAGE}", _AGAIN)
        return
    installed = Path(str(found[0].locate_file("")))
    yield ok("Drivora", f"{found[0].version}, code in {PACKAGE}")
    places = sorted({str(one.locate_file("")) for one in found})
    if len(places) > 1:
        yield problem(
            "Drivora",
            f"installed {len(places)} times, in {', '.join(places)}; the first one is used",
            "Uninstall all (`pip uninstall drivora`, once for each), then install it once",
        )
    editable = _editable_folder(found[0])
    expected = (editable or installed) / "drivora_service"
    if expected.resolve() != PACKAGE:
        yield noted(
            "Drivora",
            f"the code in {PACKAGE} is used, not the installed one in {expected}",
            "Unset PYTHONPATH, or start the command from another folder, if that is not intended",
        )


def _editable_folder(distribution: metadata.Distribution) -> Path | None:
    import json
    from urllib.parse import unquote, urlsplit

    text = distribution.read_text("direct_url.json")
    content = json.loads(text) if text else {}
    if not content.get("dir_info", {}).get("editable"):
        return None
    return Path(unquote(urlsplit(content["url"]).path))


def check_python() -> Iterator[Finding]:
    """Reports Python and the system."""
    system = platform.freedesktop_os_release().get("PRETTY_NAME", "") if _has_os_release() else ""
    yield ok(
        "Python",
        f"{platform.python_version()}, {sys.executable}; {system or platform.system()}, "
        f"{platform.machine()}, {os.cpu_count()} processors",
    )


def _has_os_release() -> bool:
    return any(Path(name).is_file() for name in ("/etc/os-release", "/usr/lib/os-release"))


def check_packages() -> Iterator[Finding]:
    """Compares the installed packages with what Drivora requires, and with the pinned versions."""
    from packaging.requirements import Requirement

    missing, wrong = [], []
    for text in metadata.requires("drivora") or ():
        requirement = Requirement(text)
        if requirement.marker is not None and not requirement.marker.evaluate({"extra": ""}):
            continue
        version = _version(requirement.name)
        if version is None:
            missing.append(str(requirement))
        elif not requirement.specifier.contains(version, prereleases=True):
            wrong.append(f"{requirement.name} {version} (required: {requirement.specifier})")
    if missing:
        yield problem("packages", f"missing: {', '.join(missing)}", _AGAIN)
    if wrong:
        yield problem("packages", f"of another version: {', '.join(wrong)}", _AGAIN)
    pins = PACKAGE.parent / "requirements" / "run.txt"
    other = _other_than_pinned(pins) if pins.is_file() else []
    if other:
        yield noted(
            "packages",
            f"not as pinned in requirements/run.txt: {', '.join(other)}",
            "`make install` installs the versions that Drivora is tested with",
        )
    if not missing and not wrong:
        names = ("libsumo", "numpy", "numba", "pyarrow", "pydantic", "sqlalchemy", "fastapi")
        shown = ", ".join(f"{name} {_version(name)}" for name in names)
        pinned = ", all as pinned" if pins.is_file() and not other else ""
        yield ok("packages", f"{shown}{pinned}")


def _other_than_pinned(pins: Path) -> list[str]:
    from packaging.markers import Marker

    other = []
    for line in pins.read_text().splitlines():
        pin = _PIN.match(line)
        if pin is None:
            continue
        name, pinned, marker = pin.groups()
        if marker and not Marker(marker.strip()).evaluate():
            continue
        version = _version(name)
        if version != pinned:
            other.append(f"{name} {version or 'missing'} (pinned: {pinned})")
    return other


def _version(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def check_libsumo() -> Iterator[Finding]:
    """Imports libsumo in a process of its own, and looks for other copies of SUMO."""
    done = subprocess.run(
        [sys.executable, "-c", "import libsumo; print(libsumo.__file__)"],
        capture_output=True,
        text=True,
        timeout=CHILD_S,
        check=False,
    )
    version = _version("libsumo") or "not installed"
    missing = system_libraries.find_missing_libraries()
    if done.returncode == 0:
        yield ok("libsumo", f"{version}, {done.stdout.strip().splitlines()[-1]}")
    else:
        reason = (done.stderr.strip() or f"its process ended with {done.returncode}").splitlines()
        remedy = _AGAIN
        if missing:
            is_root = os.geteuid() == 0
            remedy = "Run: " + system_libraries.remedy(missing, path=None, is_root=is_root).line
        yield problem("libsumo", f"{version}; cannot be loaded: {reason[-1]}", remedy)
    if missing:
        state = problem if done.returncode else noted
        yield state("libraries", f"missing on this system: {', '.join(missing)}", "")
    else:
        yield ok("libraries", ", ".join(system_libraries.PACKAGES))
    copies = [folder for folder in map(Path, sys.path) if (folder / "libsumo").is_dir()]
    if len(copies) > 1:
        yield noted(
            "libsumo",
            f"{len(copies)} copies on the path of Python, of which the first is used: "
            f"{', '.join(map(str, copies))}",
            "Unset PYTHONPATH if the first is not the one of this environment",
        )


def check_other_sumo() -> Iterator[Finding]:
    """Looks for a SUMO of another version, which programs beside Drivora may use."""
    own = _version("libsumo")
    home = os.environ.get("SUMO_HOME", "")
    programs = {"SUMO_HOME": Path(home) / "bin" / "sumo"} if home else {}
    if on_path := shutil.which("sumo"):
        programs["PATH"] = Path(on_path)
    if home and not Path(home).is_dir():
        yield noted("SUMO", f"SUMO_HOME is {home}, which is no folder", "Unset SUMO_HOME")
    for source, program in programs.items():
        if not program.is_file():
            continue
        done = subprocess.run(
            [program, "--version"], capture_output=True, text=True, timeout=CHILD_S, check=False
        )
        version = re.search(r"Version v?(\d+[._]\d+[._]\d+)", done.stdout)
        text = version.group(1).replace("_", ".") if version else "of an unknown version"
        if text == own:
            yield ok("SUMO", f"{text} of {source}: {program}")
        else:
            yield noted(
                "SUMO",
                f"{source} has SUMO {text} ({program}), Drivora uses libsumo {own}",
                "Drivora is not affected; networks that this SUMO converts may differ",
            )


def check_command() -> Iterator[Finding]:
    """Looks which ``drivora`` a shell would start."""
    own = Path(sys.executable).parent / "drivora"
    found = [
        Path(folder) / "drivora"
        for folder in os.environ.get("PATH", "").split(os.pathsep)
        if folder and os.access(Path(folder) / "drivora", os.X_OK)
    ]
    if not own.is_file():
        yield problem("command", f"{own} does not exist", _AGAIN)
    elif found and found[0].resolve() != own.resolve():
        yield noted(
            "command",
            f"`drivora` in a shell is {found[0]}, this environment's is {own}",
            f"Activate the environment: `. {own.parent}/activate`",
        )
    elif not found:
        yield noted(
            "command",
            f"{own} is not on PATH",
            f"Activate the environment: `. {own.parent}/activate`",
        )
    else:
        yield ok("command", str(own))


def check_page() -> Iterator[Finding]:
    """Looks for the built web page, and whether it is that of its sources."""
    dashboard = PACKAGE / "dashboard"
    if not (dashboard / "built" / "index.html").is_file():
        yield problem(
            "web page",
            "not built: only the API answers",
            "`make page` in a checkout; else install the wheel again",
        )
        return
    stamp, sources = dashboard / "built" / "sources.sha256", dashboard / "web"
    if sources.is_dir() and stamp.is_file():
        try:
            from drivora_service.dashboard.build import hash_of_sources
        except ImportError:
            # The tools that build it are not installed with a wheel.
            yield ok("web page", "built")
            return
        if stamp.read_text() != hash_of_sources(sources):
            yield noted("web page", "built from older sources", "`make page`")
            return
    yield ok("web page", "built")


CHECKS = (
    Check("Drivora", check_version),
    Check("Python", check_python),
    Check("command", check_command),
    Check("packages", check_packages),
    Check("libsumo", check_libsumo),
    Check("SUMO", check_other_sumo),
    Check("web page", check_page),
)
