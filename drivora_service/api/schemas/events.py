"""What the stream of events tells."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from drivora_service.shapes import Shape
from drivora_service.store.changes.change_lists import Change, ChangedKind


class EventKind(StrEnum):
    """What a stream may tell of: changes of objects by their kind, and the workers."""

    RUN = ChangedKind.RUN.value
    BATCH = ChangedKind.BATCH.value
    CAMPAIGN = ChangedKind.CAMPAIGN.value
    STUDY = ChangedKind.STUDY.value
    MINIMIZATION = ChangedKind.MINIMIZATION.value
    GROUP = ChangedKind.GROUP.value
    SUITE = ChangedKind.SUITE.value
    WORKERS = "workers"


@dataclass(frozen=True, slots=True, kw_only=True)
class Begin(Shape):
    """The beginning of a stream.

    Attributes:
        revision: Count of all changes after which the stream tells what changes.
    """

    revision: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Reset(Shape):
    """What changed before cannot be told: everything is to be asked for anew.

    Attributes:
        revision: Count of all changes after which the stream tells what changes.
    """

    revision: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Changes(Shape):
    """Objects that have changed, each once, as they are now; at most 500.

    Attributes:
        revision: Count of all changes up to which all are told.
        changes: Oldest change first.
    """

    revision: int
    changes: tuple[Change, ...]
