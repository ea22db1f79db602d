"""The genes of stored campaigns."""

from __future__ import annotations

import threading
from collections import OrderedDict
from typing import TYPE_CHECKING

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.errors import CampaignError, InvalidDocument, NetworkError, SearchError
from drivora_service.store.campaigns.campaign_records import CampaignRecord

if TYPE_CHECKING:
    from drivora_service.search.genes import GeneSpace

_MOST = 64


class GeneSpaces:
    """Builds the gene spaces of campaigns, and caches the last ones. Thread-safe."""

    def __init__(self, catalogues: Catalogues) -> None:
        """Creates an empty cache.

        Args:
            catalogues: Catalogues for the names in a campaign.
        """
        self._catalogues = catalogues
        self._known: OrderedDict[str, tuple[GeneSpace, ...]] = OrderedDict()
        self._lock = threading.Lock()

    def of(self, record: CampaignRecord, place: int) -> GeneSpace | None:
        """Returns the genes of a campaign; ``None`` if its network is no longer available.

        Args:
            record: The campaign.
            place: Place of the seed scenario in it, from 0.
        """
        with self._lock:
            if record.id not in self._known:
                built = self._build(record)
                if built is None:
                    # A missing part, such as a road network, may be installed again.
                    return None
                self._known[record.id] = built
                if len(self._known) > _MOST:
                    self._known.popitem(last=False)
            self._known.move_to_end(record.id)
            return self._known[record.id][place]

    def _build(self, record: CampaignRecord) -> tuple[GeneSpace, ...] | None:
        from drivora_service.campaigns.document.searched_space import searched_spaces_of

        try:
            return tuple(one.space for one in searched_spaces_of(record, self._catalogues))
        except (CampaignError, InvalidDocument, NetworkError, SearchError):
            return None
