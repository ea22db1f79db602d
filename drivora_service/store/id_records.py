"""What may be named in place of an id, and the answer to such a name."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from drivora_service.shapes import Shape

LATEST = "latest"
"""Stands for the newest of a kind, also where something has this name."""

_WHOLE_ID = re.compile(r"[0-9a-f]{24}(-\d{1,9}(-again)?)?")


class IdKind(StrEnum):
    """A kind of stored thing that has ids."""

    RUN = "run"
    BATCH = "batch"
    CAMPAIGN = "campaign"
    STUDY = "study"
    SUITE_RUN = "suite_run"
    MINIMIZATION = "minimization"
    FAILURE_GROUP = "failure_group"
    CONFIGURATION = "configuration"


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundId(Shape):
    """A stored thing that was named.

    Attributes:
        id: Its id.
        name: Its name: the label of a run, the suite of a suite's run, the words of a
            configuration; empty if it has none.
        created_at: When it was created; of a group of failures, when its last failure was found.
    """

    kind: IdKind
    id: str
    name: str
    created_at: datetime


def is_whole_id(text: str) -> bool:
    """Returns whether a text has the form of a whole id, which needs no lookup.

    The ids of configurations are shorter, and have the form of a prefix of others.
    """
    return _WHOLE_ID.fullmatch(text) is not None
