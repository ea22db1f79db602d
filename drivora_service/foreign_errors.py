"""Exceptions of code that is not Drivora's, in one line with file and line number."""

from __future__ import annotations

import sysconfig
import traceback
from collections.abc import Iterator
from pathlib import Path

_OWN = Path(__file__).parent
_LIBRARY = sysconfig.get_path("stdlib")
_PACKAGES = ("site-packages", "dist-packages")


def describe_exception(error: BaseException) -> str:
    """Returns type, message and place of an exception: ``ValueError: odd (/site/ads.py, line 3)``.

    The place is as :func:`exception_place` says.
    """
    message = error.msg if isinstance(error, SyntaxError) else error
    return f"{type(error).__name__}: {message}{exception_place(error)}"


def exception_place(error: BaseException) -> str:
    """Returns where foreign code raised an exception, " (FILE, line N)"; "" if that is unknown.

    That is the last place in the package of a plug-in, and not one in a library that it calls.
    """
    if isinstance(error, SyntaxError) and error.filename:
        return f" ({error.filename}, line {error.lineno})"
    places = [(file, line) for file, line in _places(error) if _is_foreign(file)]
    if not places:
        return ""
    root = _package_of(Path(places[0][0]))
    file, line = [one for one in places if Path(one[0]).is_relative_to(root)][-1]
    return f" ({file}, line {line})"


def _places(error: BaseException) -> Iterator[tuple[str, int]]:
    for frame, line in traceback.walk_tb(error.__traceback__):
        yield frame.f_code.co_filename, line


def _is_foreign(file: str) -> bool:
    """Returns whether a file is neither Drivora's nor Python's."""
    if file.startswith("<") or Path(file).is_relative_to(_OWN):
        return False
    return any(folder in file for folder in _PACKAGES) or not file.startswith(_LIBRARY)


def _package_of(file: Path) -> Path:
    """Returns the outermost folder of the package of a module, or the file if it has none."""
    root = file
    while (root.parent / "__init__.py").is_file() and root.parent != root:
        root = root.parent
    return root
