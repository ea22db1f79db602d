"""Loads one plug-in and prints as JSON why it cannot be loaded; a process of ``drivora doctor``."""

from __future__ import annotations

import json
import sys
import traceback
from importlib.metadata import EntryPoint
from pathlib import Path


def fault_of(value: str) -> str:
    """Returns why an entry point cannot be loaded, with file and line; "" if it can.

    Args:
        value: The object of the entry point, ``MODULE:NAME``.
    """
    try:
        EntryPoint(name="probed", value=value, group="").load()
    except (Exception, SystemExit) as error:
        text = f"{type(error).__name__}: {error}"
        if isinstance(error, SyntaxError) and error.filename:
            return f"{text} ({error.filename}, line {error.lineno})"
        frames = [
            frame
            for frame in traceback.extract_tb(error.__traceback__)
            if "importlib" not in frame.filename and Path(frame.filename) != Path(__file__)
        ]
        return f"{text} ({frames[-1].filename}, line {frames[-1].lineno})" if frames else text
    return ""


if __name__ == "__main__":
    fault = fault_of(sys.argv[1])
    # After all that the plug-in has printed.
    print("\n" + json.dumps(fault))
