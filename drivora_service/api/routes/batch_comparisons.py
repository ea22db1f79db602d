"""Two batches compared on the same scenarios."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends, Query, Request, Response

from drivora_service.api.context import Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import answers
from drivora_service.api.guards.authorization import reader
from drivora_service.api.guards.entity_tags import json_answer
from drivora_service.api.resource_router import resource_router
from drivora_service.errors import UnknownName
from drivora_service.oracles.verdicts.failure_definition import Counted, requested_definition
from drivora_service.suites.paired.batch_comparison import BatchComparison
from drivora_service.suites.paired.failure_rules import Rules, Unfinished

router = resource_router("batches", Depends(reader))


@router.get(
    "/batches:compare",
    response_model=BatchComparison,
    responses=answers(recorded_examples.BATCH_COMPARISON, 401, 403, 404, 422),
)
def compare_batches(
    request: Request,
    context: Context,
    a: Annotated[
        str,
        Query(
            max_length=200,
            description="Batch A: its id or the first digits of it, its name (the newest of this "
            "name), or `latest`.",
        ),
    ],
    b: Annotated[str, Query(max_length=200, description="Batch B, likewise.")],
    counts: Annotated[
        Counted | None,
        Query(
            description="The violations that are failures, in place of what was defined for the "
            "runs when they were posted."
        ),
    ] = None,
    unfinished: Annotated[
        Unfinished, Query(description="The runs without a judgement that are failures.")
    ] = Unfinished.AGENT,
    oracle: Annotated[
        list[str] | None,
        Query(
            max_length=100,
            description="Only violations of this oracle are failures, observations included; may "
            "be repeated. In place of the oracles that were defined. Without `counts`, that of the "
            "runs is kept, if all have the same.",
        ),
    ] = None,
    metric: Annotated[
        list[str] | None,
        Query(
            max_length=100,
            description="Metric to compare, and to show of each run; may be repeated. Without it, "
            "all are compared, and the driving score is shown.",
        ),
    ] = None,
) -> Response:
    """Compares two batches on the same scenarios: failures, metrics, and every pair of runs."""
    from drivora_service.suites.paired.stored_batches import compare_stored_batches

    known = context.oracles.names()
    for name in oracle or ():
        if name not in known:
            raise UnknownName("oracle", name, tuple(known))
    comparison = compare_stored_batches(
        context.database,
        a,
        b,
        rules=Rules(
            definition=None if counts is None else requested_definition(counts, oracle or ()),
            oracles=tuple(oracle or ()),
            unfinished=unfinished,
        ),
        metrics=tuple(metric or ()),
    )
    return json_answer(request, BatchComparison, comparison)
