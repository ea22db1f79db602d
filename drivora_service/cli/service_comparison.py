"""Comparisons that a service made, over HTTP."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pydantic import TypeAdapter

from drivora_service.cli.client import ServiceClient
from drivora_service.studies.comparing import Comparison
from drivora_service.studies.comparison import Row, measure
from drivora_service.studies.figures import CampaignFigures
from drivora_service.studies.statistics import Effect


def compare_on_service(
    url: str,
    wanted: Sequence[str],
    *,
    baseline: str,
    measures: Sequence[str],
    equal_time: bool,
) -> Comparison:
    """Has a service compare campaigns of its own.

    Args:
        url: Address of the service.
        wanted: Ids or names of campaigns, or patterns of names.
        baseline: Method that the others are compared with.
        measures: By what, by name; empty: by all.
        equal_time: Whether to count what each had done after the time that the shortest one took.

    Raises:
        ServiceError: The service refused or did not answer.
    """
    with ServiceClient(url) as client:
        answer = client.get(
            "/campaigns:compare",
            campaign=list(wanted),
            baseline=baseline,
            measure=list(measures),
            equal_time=equal_time,
        )
    return Comparison(
        baseline=answer["baseline"],
        figures=tuple(figures_from(item) for item in answer["campaigns"]),
        rows=tuple(_row(item, answer["baseline"]) for item in answer["differences"]),
        budgets=answer["budgets"],
        time_limits=answer["time_limits_s"],
        notes=tuple(answer["notes"]),
    )


def figures_from(item: dict[str, Any]) -> CampaignFigures:
    """Reads the figures of a campaign as a service writes them."""
    derived = ("own_share",)
    given = {name: value for name, value in item.items() if name not in derived}
    return TypeAdapter(CampaignFigures).validate_python(given)


def _row(item: dict[str, Any], baseline: str) -> Row:
    return Row(
        scenario=item["scenario"],
        measure=measure(item["measure"]),
        group=item["group"],
        baseline=baseline,
        repetitions=item["repetitions"],
        baseline_repetitions=item["baseline_repetitions"],
        median=item["median"],
        baseline_median=item["baseline_median"],
        effect=Effect(a12=item["a12"], low=item["low"], high=item["high"], p=item["p"]),
        p_holm=item["p_holm"],
    )
