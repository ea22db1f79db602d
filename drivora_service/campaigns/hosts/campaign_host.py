"""The host protocol: runs campaigns for the API, in processes of a service or in a command."""

from __future__ import annotations

from typing import Protocol

from drivora_service.store.database import Transaction


class CampaignHost(Protocol):
    """Accepts campaigns and runs each until it ends or pauses."""

    def open(self, transaction: Transaction, campaign_id: str) -> None:
        """Accepts a new campaign, in the transaction that stores it."""
        ...

    def resume(self, campaign_id: str) -> None:
        """Accepts a campaign that is not running.

        Raises:
            UnknownName: There is no such campaign.
            Conflict: It is over, or a process works on it.
        """
        ...

    def wake(self) -> None:
        """Starts accepted campaigns, or follows a request; called after the transaction."""
        ...
