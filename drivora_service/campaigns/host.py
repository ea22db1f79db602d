"""What runs campaigns for the API: the service in processes, or a command in its own."""

from __future__ import annotations

from typing import Protocol

from drivora_service.store.database import Transaction


class CampaignHost(Protocol):
    """Takes campaigns and runs them, each until it ends or rests."""

    def open(self, transaction: Transaction, campaign_id: str) -> None:
        """Takes a campaign that was just made, in the transaction that makes it."""
        ...

    def resume(self, campaign_id: str) -> None:
        """Takes a campaign that rests.

        Raises:
            UnknownName: There is no such campaign.
            Conflict: It is over, or a process works on it.
        """
        ...

    def wake(self) -> None:
        """Begins with what was taken, or acts on a request; called after the transaction."""
        ...
