"""Finding campaigns in the store by their ids or names."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from fnmatch import fnmatchcase

from drivora_service.errors import UnknownName
from drivora_service.store.campaigns.campaign_records import CampaignRecord, CampaignSummary
from drivora_service.store.database import Database
from drivora_service.store.id_lookup import find_id
from drivora_service.store.id_records import LATEST, IdKind

_PAGE = 200
_MOST_NAMED = 20


def choose_campaigns(database: Database, wanted: Sequence[str]) -> tuple[CampaignRecord, ...]:
    """Returns the chosen campaigns, oldest first, each once.

    Args:
        database: Holds the campaigns.
        wanted: Ids, ``latest``, names, patterns of names (``study-*``), or the first digits of
            ids; a name stands for all campaigns of that name.

    Raises:
        UnknownName: One of them matches no campaign.
        AmbiguousName: The ids of several campaigns begin with one of them.
    """
    ids = campaign_ids(database, wanted)
    with database.read() as transaction:
        return tuple(transaction.campaigns.get(one) for one in ids)


def campaign_ids(database: Database, wanted: Sequence[str]) -> tuple[str, ...]:
    """Returns the ids of the campaigns that :func:`choose_campaigns` chooses.

    Raises:
        UnknownName: One of them matches no campaign.
    """
    if not wanted:
        return ()
    known = _all(database)
    chosen: set[str] = set()
    for one in wanted:
        fitting = {known[-1].id} if one == LATEST and known else set()
        fitting = fitting or {r.id for r in known if one in (r.id, r.name)}
        fitting = fitting or {r.id for r in known if fnmatchcase(r.name, one)}
        fitting = fitting or _begun_by(database, one)
        if not fitting:
            names = tuple(dict.fromkeys(r.name for r in reversed(known)))
            raise UnknownName(
                "campaign",
                one,
                names[:_MOST_NAMED] + (("…",) if len(names) > _MOST_NAMED else ()),
                hint="Give ids, names, patterns such as 'study-*', or latest",
            )
        chosen |= fitting
    return tuple(one.id for one in known if one.id in chosen)


def _begun_by(database: Database, text: str) -> set[str]:
    """Returns the id of the campaign whose id begins with a text, if there is one."""
    with database.read() as transaction, suppress(UnknownName):
        return {find_id(transaction.session, [IdKind.CAMPAIGN], text).id}
    return set()


def _all(database: Database) -> list[CampaignSummary]:
    """Returns every campaign, oldest first."""
    found: list[CampaignSummary] = []
    token = ""
    while True:
        with database.read() as transaction:
            page = transaction.campaigns.page(limit=_PAGE, page_token=token)
        found += page.items
        token = page.next_page_token
        if not token:
            return found[::-1]
