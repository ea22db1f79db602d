"""The genes of campaigns that are in the database."""

from __future__ import annotations

import threading
from collections import OrderedDict

from drivora_service.campaigns.catalogues import Catalogues
from drivora_service.campaigns.ground import ground_of
from drivora_service.errors import CampaignError, InvalidDocument, NetworkError, SearchError
from drivora_service.search.genes import GeneSpace
from drivora_service.store.campaign_records import CampaignRecord

_MOST = 64


class GeneSpaces:
    """Builds the gene spaces of campaigns, each once, and keeps the last ones that were asked for.

    Safe to use from several threads.
    """

    def __init__(self, catalogues: Catalogues) -> None:
        """Begins with none.

        Args:
            catalogues: Where the names in a campaign are looked up.
        """
        self._catalogues = catalogues
        self._known: OrderedDict[str, GeneSpace] = OrderedDict()
        self._lock = threading.Lock()

    def of(self, record: CampaignRecord) -> GeneSpace | None:
        """Returns the genes of a campaign; ``None`` if its network is no longer available."""
        with self._lock:
            if record.id not in self._known:
                built = self._build(record)
                if built is None:
                    # What is missing may come back, such as a road network.
                    return None
                self._known[record.id] = built
                if len(self._known) > _MOST:
                    self._known.popitem(last=False)
            self._known.move_to_end(record.id)
            return self._known[record.id]

    def _build(self, record: CampaignRecord) -> GeneSpace | None:
        try:
            return ground_of(record, self._catalogues).space
        except (CampaignError, InvalidDocument, NetworkError, SearchError):
            return None
