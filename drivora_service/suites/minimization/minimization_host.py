"""The host protocol: runs minimisations for the API, in a service or in a command."""

from __future__ import annotations

from typing import Protocol


class MinimizationHost(Protocol):
    """Runs the stored minimisations of its process until they end."""

    def wake(self) -> None:
        """Signals a new or cancelled minimisation; called after the transaction."""
        ...
