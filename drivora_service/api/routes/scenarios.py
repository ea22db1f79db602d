"""Checking a scenario without running it."""

from __future__ import annotations

import hashlib

from fastapi import Depends, Request

from drivora_service.api import bodies, examples
from drivora_service.api.context import Context
from drivora_service.api.documentation import answers, scenario_body
from drivora_service.api.parameters import RunOverrides
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.service import Validation
from drivora_service.api.security import submitter
from drivora_service.api.submission import Checker, check_overrides
from drivora_service.scenario.canonical import canonical_json

router = resource_router("scenarios")


@router.post(
    "/scenarios:validate",
    response_model=Validation,
    responses=answers(examples.VALIDATION, 401, 403, 413, 415, 422),
    openapi_extra=scenario_body(examples.SCENARIO),
    dependencies=[Depends(submitter)],
)
def validate_scenario(
    request: Request, context: Context, body: bodies.RawBody, overrides: RunOverrides
) -> Validation:
    """Checks a scenario as posting it would, and answers with the same problems."""
    form = bodies.document_format(request)
    check_overrides(context, overrides)
    valid = Checker(context, overrides).validated(body, form)
    text = canonical_json(valid.scenario)
    agents = dict.fromkeys(ego.agent.name for ego in valid.scenario.ego_vehicles)
    return Validation(
        valid=True,
        town=valid.scenario.map_region.town,
        agents=(overrides.agent,) if overrides.agent else tuple(agents),
        scenario_sha256=hashlib.sha256(text.encode()).hexdigest(),
        notes=valid.notes,
    )
