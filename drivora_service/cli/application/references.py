"""What users name in place of ids: the one module by which commands turn names into ids.

A name is looked up once, before a command does anything, so that all its requests are about the
same thing even if something newer is created meanwhile. A whole id is taken as it is, without a
request.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from datetime import datetime
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.errors import NotFound
from drivora_service.store.id_records import IdKind, is_whole_id

if TYPE_CHECKING:
    from drivora_service.client import Client

_NAMED_BY = "id, first digits of it, name, or latest"

RunArgument = Annotated[
    str,
    typer.Argument(metavar="RUN", help=f"A run ({_NAMED_BY}), or CAMPAIGN-EVALUATION."),
]
BatchArgument = Annotated[str, typer.Argument(metavar="BATCH", help=f"A batch ({_NAMED_BY}).")]
CampaignArgument = Annotated[
    str, typer.Argument(metavar="CAMPAIGN", help=f"A campaign ({_NAMED_BY}).")
]
StudyArgument = Annotated[str, typer.Argument(metavar="STUDY", help=f"A study ({_NAMED_BY}).")]
GroupArgument = Annotated[
    str, typer.Argument(metavar="GROUP", help=f"A group of failures ({_NAMED_BY}).")
]
GroupOption = Annotated[
    str, typer.Option("--group", metavar="GROUP", help=f"Of this group ({_NAMED_BY}).")
]
BatchOption = Annotated[
    str, typer.Option("--batch", metavar="BATCH", help=f"Of runs of this batch ({_NAMED_BY}).")
]
CampaignOption = Annotated[
    str,
    typer.Option("--campaign", metavar="CAMPAIGN", help=f"Found by this campaign ({_NAMED_BY})."),
]
StudyOption = Annotated[
    str, typer.Option("--study", metavar="STUDY", help=f"Found by this study ({_NAMED_BY}).")
]
ConfigurationOption = Annotated[
    str,
    typer.Option(
        "--configuration",
        metavar="CONFIGURATION",
        help=f"Of an agent with all its parameters ({_NAMED_BY}); `runs show` prints the id.",
    ),
]


def id_of(client: Client, wanted: str, *kinds: IdKind) -> str:
    """Returns the id of what a user named.

    Args:
        client: Client of the application or service that stores it.
        wanted: An id, ``latest``, a name, or the first digits of an id; "": nothing.
        kinds: What may be meant, at least one.

    Raises:
        NotFound: Nothing fits, or several things do.
    """
    if not wanted or is_whole_id(wanted):
        return wanted
    return client.find_id(kinds, wanted).id


def ids_of(client: Client, wanted: Iterable[str], *kinds: IdKind) -> tuple[str, ...]:
    """Returns the ids of what a user named, each once, in this order.

    Raises:
        NotFound: Nothing fits one of them, or several things do.
    """
    return tuple(dict.fromkeys(id_of(client, one, *kinds) for one in wanted))


def baseline_id(client: Client, wanted: str) -> str:
    """Returns the id of the batch, campaign or study that is a baseline, or the time that is one.

    Raises:
        NotFound: Nothing fits, or several things do.
    """
    with suppress(ValueError):
        if datetime.fromisoformat(wanted).tzinfo is not None:
            return wanted
    try:
        return id_of(client, wanted, IdKind.BATCH, IdKind.CAMPAIGN, IdKind.STUDY)
    except NotFound as error:
        also = "A time such as 2026-11-20T08:00:00Z is a baseline, too"
        raise NotFound(f"{error}\n{also}", status=error.status) from error
