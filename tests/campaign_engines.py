"""The processes of a service's campaigns, as their logs tell."""

from __future__ import annotations

import re
from pathlib import Path

_BEGUN = re.compile(r"^process (\d+) runs campaign", re.MULTILINE)


def engine_pid(campaign_folder: Path) -> int:
    """Returns the process that was started last for a campaign; 0 if there was none."""
    log = campaign_folder / "engine.log"
    found = _BEGUN.findall(log.read_text()) if log.is_file() else []
    return int(found[-1]) if found else 0
