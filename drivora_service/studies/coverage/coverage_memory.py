"""The coverage of the campaigns that were asked for last, counted as they go on."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from drivora_service.store.database import Database
    from drivora_service.studies.coverage.campaign_coverage import CoverageCounts
    from drivora_service.studies.coverage.coverage_values import CampaignCoverage

_PAGE = 500


class CoverageMemory:
    """The counts of the last campaigns that were asked for. Thread-safe."""

    def __init__(self, most: int = 16, most_at_once: int = 1000) -> None:
        """Creates an empty memory.

        Args:
            most: Campaigns whose counts are kept.
            most_at_once: Evaluations that one question counts, some seconds of work.
        """
        self._most, self._most_at_once = most, most_at_once
        self._known: OrderedDict[str, CoverageCounts] = OrderedDict()
        self._lock = threading.Lock()

    def coverage(
        self, database: Database, campaign_id: str, made: Callable[[], CoverageCounts]
    ) -> CampaignCoverage:
        """Counts the next evaluations of a campaign and returns what is covered.

        Args:
            database: Holds the campaign.
            campaign_id: Id of the campaign.
            made: Makes counts for a campaign that is not known.

        Raises:
            UnknownName: There is no such campaign, or a road network is not there any more.
        """
        with self._lock:
            with database.read() as transaction:
                evaluations = transaction.campaigns.get(campaign_id).counts.evaluations
            counts = self._known.get(campaign_id) or made()
            goal = min(counts.counted + self._most_at_once, evaluations)
            while counts.counted < goal:
                with database.read() as transaction:
                    rows = transaction.campaign_rows.candidates(
                        campaign_id,
                        after=counts.counted - 1,
                        limit=min(_PAGE, goal - counts.counted),
                    )
                if not rows:
                    break
                counts.add(rows)
            self._known[campaign_id] = counts
            self._known.move_to_end(campaign_id)
            if len(self._known) > self._most:
                self._known.popitem(last=False)
            return counts.coverage(campaign_id, evaluations)
