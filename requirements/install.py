"""Runs pip, uv or a build, and prints how far it is: ``python install.py COMMAND…``.

With ``--quiet``, pip prints nothing for a minute, and without it hundreds of lines. This prints a
line every few seconds, with and without a terminal. It uses the standard library alone, as it runs
before anything is installed.
"""

from __future__ import annotations

import re
import subprocess
import sys
import sysconfig
import threading
import time
from itertools import pairwise
from pathlib import Path

EVERY_S = 2.5
"""Seconds between two lines."""

_FETCHED = re.compile(r"^\s*(Using cached|Downloading) (\S+?)(?:\.metadata)? \(([\d.]+) (\w+)\)")
_UNITS = {"bytes": 1e-6, "kB": 1e-3, "MB": 1.0, "GB": 1e3}
_PINNED = re.compile(r"^([A-Za-z0-9._-]+)(?:\[[\w,-]*\])?==\S+(?: ; (.*?))?\s*\\?$")
_PASSED_ON = ("WARNING", "ERROR", "error:", "  error:", "DEPRECATION")
_LAST_LINES = 50


class Progress:
    """What pip has done so far, from the lines that it prints."""

    def __init__(self, packages: int, installed: int) -> None:
        """Nothing is fetched yet.

        Args:
            packages: Packages to install; 0: the command installs none that are known.
            installed: Packages that the environment has before.
        """
        self.packages, self._before = packages, installed
        self.fetched, self.megabytes, self.downloaded = 0, 0.0, 0.0
        self.file = ""
        self.unpacks = False

    def read(self, line: str) -> None:
        """Reads a line of pip's output."""
        if found := _FETCHED.match(line):
            how, self.file, size, unit = found.groups()
            if self.file.endswith((".whl", ".tar.gz", ".zip")) and ".metadata" not in line:
                megabytes = float(size) * _UNITS.get(unit, 0.0)
                self.fetched += 1
                self.megabytes += megabytes
                self.downloaded += megabytes if how == "Downloading" else 0.0
        elif line.startswith(("Installing collected packages", "Prepared ")):
            self.unpacks = True

    def state(self, installed: int, seconds: float) -> str:
        """Returns what is being done, as a line.

        Args:
            installed: Packages that the environment has now.
            seconds: Since the start.
        """
        if not self.packages:
            return f"  still at work, {seconds:.0f} s"
        if self.unpacks:
            done = min(installed - self._before, self.packages)
            size = f" {self.megabytes:.0f} MB" if self.megabytes else ""
            return f"  unpacking{size}: {done} of {self.packages} packages, {seconds:.0f} s"
        if not self.fetched:
            return f"  looking for packages, {seconds:.0f} s"
        name = self.file.split("-")[0]
        return (
            f"  fetching: {self.fetched} of {self.packages} packages, {self.megabytes:.0f} MB "
            f"({self.downloaded:.0f} MB downloaded), now {name}, {seconds:.0f} s"
        )


def pinned_packages(file: Path) -> int:
    """Returns the number of packages that a file of requirements pins for this system."""
    lines = map(_PINNED.match, file.read_text().splitlines())
    return sum(1 for found in lines if found and "win32" not in (found.group(2) or ""))


def installed_packages() -> int:
    """Returns the number of packages of the environment of this Python."""
    return sum(1 for _ in Path(sysconfig.get_path("purelib")).glob("*.dist-info"))


def run(command: list[str]) -> int:
    """Runs a command with progress; returns its exit code."""
    files = [Path(name) for flag, name in pairwise(command) if flag == "-r"]
    packages = sum(map(pinned_packages, files))
    if files:
        names = ", ".join(map(str, files))
        print(f"Installing {packages} packages of {names}", flush=True)
    begun = time.monotonic()
    progress = Progress(packages, installed_packages())
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace"
    )
    lines: list[str] = []

    def read() -> None:
        assert process.stdout is not None
        for line in process.stdout:
            progress.read(line)
            text = line.rstrip()
            # pip repeats some of its warnings for each package.
            if text.startswith(_PASSED_ON) and text not in lines:
                print(f"  {text}", flush=True)
            lines.append(text)

    reader = threading.Thread(target=read, daemon=True)
    reader.start()
    while True:
        reader.join(EVERY_S)
        if not reader.is_alive():
            break
        print(progress.state(installed_packages(), time.monotonic() - begun), flush=True)
    code = process.wait()
    if code:
        print("\n".join(lines[-_LAST_LINES:]), file=sys.stderr)
        print(f"`{' '.join(command)}` ended with {code}", file=sys.stderr)
    elif files:
        size = f", {progress.megabytes:.0f} MB" if progress.megabytes else ""
        print(f"  installed{size} in {time.monotonic() - begun:.0f} s", flush=True)
    return code


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:]))
