"""Where the settings of an installation put the traces."""

from __future__ import annotations

from drivora_service.settings import Settings
from drivora_service.store.traces.trace_places import TracePlaces


def trace_places(settings: Settings) -> TracePlaces:
    """Returns the places of the traces of an installation."""
    return TracePlaces(
        runs=settings.traces_dir,
        campaigns=settings.campaigns_dir,
        url=settings.traces_url,
        copies=settings.data_dir / "copies",
    )
