"""Runs SUMO's netconvert, which only the extra ``networks`` brings."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import os
import re
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

from drivora_service.errors import NetworkError

# The time, the machine's paths and the options: different on every machine.
_HEADER = re.compile(rb"<!-- generated on .*?-->\s*", re.DOTALL)
_SHOWN_ERRORS = 5


def netconvert_version() -> str:
    """Gives the version of the installed netconvert, such as ``1.28.0``.

    Raises:
        NetworkError: It is not installed.
    """
    _sumo_home()
    try:
        return importlib.metadata.version("eclipse-sumo")
    except importlib.metadata.PackageNotFoundError:
        raise _missing() from None


def convert(arguments: Sequence[str], *, timeout: float = 600.0) -> bytes:
    """Runs netconvert and gives the network it wrote, without the header that varies.

    Args:
        arguments: Everything but the output file.
        timeout: Seconds after which the conversion is given up.

    Raises:
        NetworkError: netconvert is not installed, refused its input or took too long.
    """
    home = _sumo_home()
    environment = os.environ | {"SUMO_HOME": str(home), "PROJ_DATA": str(home / "data" / "proj")}
    with tempfile.TemporaryDirectory(prefix="drivora-netconvert-") as directory:
        output = Path(directory) / "network.net.xml"
        command = [str(home / "bin" / "netconvert"), *arguments, "--output-file", str(output)]
        try:
            ended = subprocess.run(
                command,
                env=environment,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                text=True,
                errors="replace",
                timeout=timeout,
                check=False,
            )
        except subprocess.TimeoutExpired:
            raise NetworkError(f"netconvert did not finish within {timeout:g} s") from None
        if ended.returncode != 0 or not output.is_file():
            raise NetworkError(f"netconvert failed: {_summary(ended.stdout + ended.stderr)}")
        return _HEADER.sub(b"", output.read_bytes(), count=1)


def _sumo_home() -> Path:
    spec = importlib.util.find_spec("sumo")
    for location in (spec.submodule_search_locations or []) if spec else []:
        if (Path(location) / "bin" / "netconvert").exists():
            return Path(location)
    raise _missing()


def _missing() -> NetworkError:
    return NetworkError(
        "netconvert is not installed; it comes with an extra: pip install '.[networks]' in the "
        "checkout"
    )


def _summary(printed: str) -> str:
    lines = [line.strip() for line in printed.splitlines()]
    errors = [
        line.removeprefix("Error: ").rstrip(".") for line in lines if line.startswith("Error: ")
    ]
    errors = errors or [line for line in lines if line and not line.startswith("Warning: ")][-1:]
    hidden = len(errors) - _SHOWN_ERRORS
    more = [f"and {hidden} more errors"] if hidden > 0 else []
    return "; ".join(errors[:_SHOWN_ERRORS] + more) or "it gave no reason"
