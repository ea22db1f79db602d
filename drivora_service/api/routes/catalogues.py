"""The catalogues of agents, actor models, testers, oracles and metrics."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastapi import Depends, Request, Response

from drivora_service.api.context import Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import answers
from drivora_service.api.guards.authorization import reader
from drivora_service.api.guards.entity_tags import json_answer
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.catalogues import (
    Agent,
    AgentList,
    AgentParameter,
    MeasureList,
    Model,
    ModelList,
    Oracle,
    OracleList,
    Tester,
    TesterList,
    TesterParameter,
)
from drivora_service.errors import SearchError
from drivora_service.feedback.objective_descriptions import (
    OBJECTIVES,
    law_objectives,
    oracle_objectives,
)
from drivora_service.parameters import describe_parameters
from drivora_service.scenario.models.actor_models import ActorKind, actor_model, model_names

if TYPE_CHECKING:
    from drivora_service.agents.catalogue import AgentCatalogue
    from drivora_service.oracles.catalogue import OracleCatalogue
    from drivora_service.search.catalogue import TesterCatalogue

router = resource_router("catalogues", Depends(reader))


@router.get(
    "/agents", response_model=AgentList, responses=answers(recorded_examples.AGENTS, 401, 403)
)
def list_agents(request: Request, context: Context) -> Response:
    """Lists the ADSs that can drive an ego."""
    items = tuple(_agent(context.agents, name) for name in context.agents.names())
    return json_answer(request, AgentList, AgentList(items=items))


@router.get(
    "/models", response_model=ModelList, responses=answers(recorded_examples.MODELS, 401, 403)
)
def list_models(request: Request) -> Response:
    """Lists the models of vehicles, walkers and obstacles that documents can name."""
    models = [actor_model(kind, name) for kind in ActorKind for name in model_names(kind)]
    items = tuple(
        Model(
            name=model.name,
            kind=model.kind,
            vehicle_class=model.vehicle_class,
            length=model.length,
            width=model.width,
            height=model.height,
            max_speed=model.max_speed,
        )
        for model in models
    )
    return json_answer(request, ModelList, ModelList(items=items))


@router.get(
    "/testers", response_model=TesterList, responses=answers(recorded_examples.TESTERS, 401, 403)
)
def list_testers(request: Request, context: Context) -> Response:
    """Lists the testing methods that a campaign can name, with their parameters."""
    catalogue = context.catalogues.testers
    items = tuple(_tester(catalogue, name) for name in catalogue.names())
    return json_answer(request, TesterList, TesterList(items=items))


@router.get(
    "/oracles", response_model=OracleList, responses=answers(recorded_examples.ORACLES, 401, 403)
)
def list_oracles(request: Request, context: Context) -> Response:
    """Lists the oracles that judge every run, with their thresholds."""
    items = tuple(_oracle(context.oracles, name) for name in context.oracles.names())
    return json_answer(request, OracleList, OracleList(items=items))


@router.get(
    "/metrics:describe",
    response_model=MeasureList,
    responses=answers(recorded_examples.MEASURES, 401, 403),
)
def describe_metrics(request: Request, context: Context) -> Response:
    """Describes the metrics of runs and the objectives of searches."""
    library = context.oracles.library
    laws = law_objectives([library.law(name) for name in library.names()])
    own = oracle_objectives(context.oracles.objectives())
    metrics = context.catalogues.metrics.descriptions()
    items = (*metrics, *OBJECTIVES, *own, *laws)
    return json_answer(request, MeasureList, MeasureList(items=items))


def _agent(catalogue: AgentCatalogue, name: str) -> Agent:
    entry, parameters = catalogue.entry(name), catalogue.parameters(name)
    return Agent(
        name=entry.name,
        kind=str(entry.kind),
        description=entry.description,
        source=entry.source,
        licence=entry.licence,
        version=entry.version,
        parameters=None
        if parameters is None
        else tuple(
            AgentParameter(
                name=parameter.name,
                default=parameter.default,
                values=dict(parameter.schema),
                description=parameter.description,
            )
            for parameter in parameters
        ),
        privileged=entry.privileged,
        installed=entry.installed,
        reason=entry.reason,
    )


def _tester(catalogue: TesterCatalogue, name: str) -> Tester:
    try:
        plugin = catalogue.plugin(name)
    except SearchError as error:
        return Tester(
            name=name,
            title=name,
            description="",
            source="",
            generational=False,
            feedback="",
            parameters=(),
            installed=False,
            reason=str(error),
        )
    return Tester(
        name=plugin.name,
        title=plugin.title,
        description=plugin.description,
        source=plugin.source,
        generational=plugin.is_generational,
        feedback=plugin.feedback.name,
        parameters=tuple(
            TesterParameter(
                name=parameter.name,
                default=parameter.default,
                values=dict(parameter.schema),
                description=parameter.description,
            )
            for parameter in describe_parameters(plugin.parameters)
        ),
        installed=True,
        reason="",
    )


def _oracle(catalogue: OracleCatalogue, name: str) -> Oracle:
    entry, told = catalogue.entry(name), catalogue.description(name)
    return Oracle(
        name=entry.name,
        description=entry.description,
        definition=entry.description if told is None else told.definition,
        severity=None if told is None else told.severity,
        unit="" if told is None else told.unit,
        violated_by=None if told is None else told.violated_by,
        source=entry.package if told is None else told.source,
        threshold_descriptions=() if told is None else told.thresholds,
        thresholds=dict(entry.thresholds),
        package=entry.package,
        formula=entry.formula,
        file=entry.file,
        installed=not entry.reason,
        reason=entry.reason,
    )
