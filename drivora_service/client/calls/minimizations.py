"""Minimisations of failing runs."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from drivora_service.api_paths import PREFIX
from drivora_service.client.call import Call, Listing, act, get, make_listing, post

if TYPE_CHECKING:
    from drivora_service.api.schemas.minimizations import Minimization
    from drivora_service.store.minimizations.minimization_records import MinimizationSummary

_MINIMIZATION = f"{PREFIX}/minimizations/{{minimization_id}}"


def minimize(
    run_id: str,
    *,
    oracle: str = "",
    radius_m: float | None = None,
    budget: int | None = None,
) -> Call[Minimization]:
    """Has the service search the smallest scenario that fails as a run does.

    Args:
        run_id: Id of the run.
        oracle: Oracle whose violation is followed; "": the gravest is.
        radius_m: Metres within which a violation is at the same place; ``None``: as the service
            has it.
        budget: Simulations that the search may need; ``None``: as the service has it.

    Raises:
        RequestConflict: The run has no such violation.
    """
    from drivora_service.api.schemas.minimizations import Minimization

    wanted = {"oracle": oracle, "radius_m": radius_m, "budget": budget}
    body = {name: value for name, value in wanted.items() if value is not None}
    return post(
        f"{PREFIX}/runs/{{run_id}}:minimize",
        Minimization,
        json.dumps(body).encode(),
        run_id=run_id,
    )


def minimizations(*, run_id: str = "", limit: int | None = None) -> Listing[MinimizationSummary]:
    """Returns minimisations, newest first.

    Args:
        run_id: Only those of this run; "": of any.
        limit: How many at most; ``None``: all.
    """
    from drivora_service.store.minimizations.minimization_records import MinimizationSummary

    return make_listing(
        f"{PREFIX}/minimizations", MinimizationSummary, limit, query={"run": run_id}
    )


def minimization(minimization_id: str) -> Call[Minimization]:
    """Returns how far a minimisation is; :meth:`wait_for_minimization` waits for its end."""
    from drivora_service.api.schemas.minimizations import Minimization

    return get(_MINIMIZATION, Minimization, minimization_id=minimization_id)


def cancel_minimization(minimization_id: str) -> Call[Minimization]:
    """Cancels a minimisation and its runs; the smallest scenario so far stays."""
    from drivora_service.api.schemas.minimizations import Minimization

    return act(f"{_MINIMIZATION}:cancel", Minimization, minimization_id=minimization_id)
