"""Checking a scenario without running it, what an editor shows of it, and examples."""

from __future__ import annotations

import hashlib

from fastapi import Depends, Request, Response

from drivora_service.api.answers import request_bodies
from drivora_service.api.answers.catalogue_lookups import KnownAgents, KnownNetworks
from drivora_service.api.answers.query_parameters import RunOverrides
from drivora_service.api.answers.submission import Checker, check_overrides
from drivora_service.api.context import Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import answers, scenario_body
from drivora_service.api.guards.authorization import reader, submitter
from drivora_service.api.guards.entity_tags import json_answer
from drivora_service.api.problem_details import problem_items
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.catalogues import ExampleScenario, ExampleScenarioList
from drivora_service.api.schemas.service import InspectedActor, Inspection, Validation
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.shipped import shipped_scenarios

router = resource_router("scenarios")


@router.post(
    "/scenarios:validate",
    response_model=Validation,
    responses=answers(recorded_examples.VALIDATION, 401, 403, 413, 415, 422),
    openapi_extra=scenario_body(recorded_examples.SCENARIO),
    dependencies=[Depends(submitter)],
)
def validate_scenario(
    request: Request, context: Context, body: request_bodies.RawBody, overrides: RunOverrides
) -> Validation:
    """Checks a scenario as posting it would, and answers with the same problems."""
    form = request_bodies.document_format(request)
    check_overrides(context, overrides)
    valid = Checker(context, overrides).validate(body, form)
    text = canonical_json(valid.scenario)
    agents = dict.fromkeys(ego.agent.name for ego in valid.scenario.ego_vehicles)
    return Validation(
        valid=True,
        town=valid.scenario.map_region.town,
        agents=(overrides.agent,) if overrides.agent else tuple(agents),
        scenario_sha256=hashlib.sha256(text.encode()).hexdigest(),
        notes=valid.notes,
    )


@router.post(
    "/scenarios:inspect",
    response_model=Inspection,
    responses=answers(recorded_examples.INSPECTION, 401, 403, 413, 415, 422),
    openapi_extra=scenario_body(recorded_examples.SCENARIO),
    dependencies=[Depends(reader)],
)
def inspect_scenario(
    request: Request, context: Context, body: request_bodies.RawBody
) -> Inspection:
    """Returns the problems of a scenario, and its actors with their ways, valid or not."""
    # Imported here: it needs the compiler of kernels.
    from drivora_service.scenario.inspection import inspect_data

    form = request_bodies.document_format(request)
    agents = KnownAgents(context.agents.availability())
    found = inspect_data(body, KnownNetworks(context.networks), agents, form)
    return Inspection(
        valid=not found.problems,
        town=found.town,
        problems=tuple(problem_items(found.problems)),
        notes=found.notes,
        actors=tuple(
            InspectedActor(
                pointer=actor.pointer,
                id=actor.id,
                kind=actor.kind,
                x=actor.x,
                y=actor.y,
                yaw=actor.yaw,
                length=actor.length,
                width=actor.width,
                path=tuple(map(tuple, actor.path.round(2).tolist())),
                path_length=round(actor.path_length, 2),
            )
            for actor in found.actors
        ),
    )


@router.get(
    "/scenarios:examples",
    response_model=ExampleScenarioList,
    responses=answers(recorded_examples.EXAMPLE_SCENARIOS, 401, 403),
    dependencies=[Depends(reader)],
)
def list_examples(request: Request) -> Response:
    """Lists the example scenarios that come with the package."""
    items = tuple(
        ExampleScenario(name=name, document=dict(document))
        for name, document in shipped_scenarios().items()
    )
    return json_answer(request, ExampleScenarioList, ExampleScenarioList(items=items))
