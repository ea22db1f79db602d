"""Ids of what is stored, by names, by their first digits, or of the newest."""

from __future__ import annotations

from typing import TYPE_CHECKING

from drivora_service.api_paths import PREFIX
from drivora_service.client.call import Call, get

if TYPE_CHECKING:
    from collections.abc import Sequence

    from drivora_service.store.id_records import FoundId, IdKind


def find_id(kinds: Sequence[IdKind], wanted: str) -> Call[FoundId]:
    """Returns the one stored thing that a name or the beginning of an id means.

    Args:
        kinds: Kinds that are meant, at least one.
        wanted: ``latest``, the newest; an id, or its first digits; a name; of a run also
            ``CAMPAIGN-EVALUATION``.
    """
    from drivora_service.store.id_records import FoundId

    query = {"kind": tuple(kinds), "wanted": wanted}
    return get(f"{PREFIX}/ids", FoundId, query=query)
