"""The dependencies of the endpoints, built once by the composition root."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from fastapi import Depends, Request

from drivora_service.api.guards.client_waits import MOST_OF_A_CLIENT
from drivora_service.api_paths import PREFIX

if TYPE_CHECKING:
    from drivora_service.agents.catalogue import AgentCatalogue
    from drivora_service.api.answers.network_imports import NetworkImports
    from drivora_service.api.guards.api_tokens import TokenFile
    from drivora_service.api.guards.page_sessions import SessionFile
    from drivora_service.campaigns.document.campaign_catalogues import Catalogues
    from drivora_service.campaigns.document.stored_gene_spaces import GeneSpaces
    from drivora_service.campaigns.hosts.campaign_host import CampaignHost
    from drivora_service.campaigns.records.campaign_folder import CampaignFolder
    from drivora_service.networks.catalogue import NetworkCatalogue
    from drivora_service.oracles.catalogue import OracleCatalogue
    from drivora_service.runs.slot_state import SlotState
    from drivora_service.store.database import Database
    from drivora_service.studies.study_host import StudyHost
    from drivora_service.suites.minimization.minimization_host import MinimizationHost


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Limits of requests.

    Attributes:
        body_bytes: Size of a request's body.
        network_bytes: Size of a file that a road network is imported from.
        batch_items: Scenarios of a batch.
        queued_runs: Runs that may wait; more are refused.
        body_s: Seconds for which a client may send nothing of a body; ``None``: the default.
        client_bodies: Bodies of one client that are waited for at the same moment.
    """

    body_bytes: int
    network_bytes: int
    batch_items: int
    queued_runs: int
    body_s: float | None = None
    client_bodies: int = MOST_OF_A_CLIENT


@dataclass(frozen=True, slots=True, kw_only=True)
class ApiContext:
    """Everything below the HTTP layer.

    Attributes:
        opened: Returns the database, and opens it if it is not open yet.
        revision: Returns another number after each change of the database, without waiting;
            ``None``: not known.
        catalogues: Catalogues for the names in documents.
        tokens: API tokens; ``None``: no token is ever needed.
        sessions: Sessions of web pages, which begin with a token; ``None``: there are none.
        trace_path: Returns the path of a run's trace, by the run's id.
        gene_spaces: Names the genes of campaigns.
        campaign_folder: Returns the folder of a campaign, by its id.
        wake: Tells the dispatcher that there is work.
        campaigns: Runs campaigns.
        studies: Runs studies.
        minimizations: Runs minimisations.
        imports: Imports uploaded road networks.
        reserve: Gets ready for so many runs; returns the process that they are for, "" for any
            server.
        faults: Returns the conditions of readiness by name, each with its fault and what to do, or
            "", without waiting.
        storage_fault: Returns why nothing can be stored and what to do, or "", without waiting.
        stopping: Whether the service takes no more work because it is being stopped.
        owner_id: Id under which this process takes runs; "": it takes none by itself.
        own_slots: Returns the present state of its worker slots.
        root_path: Path that the service is under behind a proxy; "": the root of its host.
        is_public_https: Whether its public address is one of HTTPS.
        is_service: Whether others ask than the process itself: they are not told the inside.
    """

    opened: Callable[[], Database]
    revision: Callable[[], int | None]
    catalogues: Catalogues
    tokens: TokenFile | None
    limits: Limits
    trace_path: Callable[[str], Path]
    gene_spaces: GeneSpaces
    campaign_folder: Callable[[str], CampaignFolder]
    wake: Callable[[], None]
    campaigns: CampaignHost
    studies: StudyHost
    minimizations: MinimizationHost
    imports: NetworkImports
    reserve: Callable[[int], str]
    faults: Callable[[], Mapping[str, str]]
    storage_fault: Callable[[], str]
    stopping: Callable[[], bool]
    is_service: bool = True
    sessions: SessionFile | None = None
    owner_id: str = ""
    own_slots: Callable[[], tuple[SlotState, ...]] = tuple
    root_path: str = ""
    is_public_https: bool = False

    @property
    def base(self) -> str:
        """Address of the API, as its clients see it."""
        return f"{self.root_path}{PREFIX}"

    @property
    def database(self) -> Database:
        """The database.

        Raises:
            StoreError: It cannot be used.
        """
        return self.opened()

    @property
    def needed_tokens(self) -> TokenFile | None:
        """The API tokens if a request needs one at the moment, else ``None``."""
        return self.tokens if self.tokens is not None and self.tokens.are_needed else None

    @property
    def networks(self) -> NetworkCatalogue:
        """Road networks by name."""
        return self.catalogues.networks

    @property
    def agents(self) -> AgentCatalogue:
        """ADSs by name."""
        return self.catalogues.agents

    @property
    def oracles(self) -> OracleCatalogue:
        """Oracles by name."""
        return self.catalogues.oracles


def context_of(request: Request) -> ApiContext:
    """Returns the context of the application that serves a request."""
    context: ApiContext = request.app.state.context
    return context


async def _context(request: Request) -> ApiContext:
    # In the event loop: a plain function would take a thread for it.
    return context_of(request)


Context = Annotated[ApiContext, Depends(_context)]
