"""Comparisons that a service made, over HTTP."""

from __future__ import annotations

from collections.abc import Sequence

from drivora_service.cli.client import ServiceClient
from drivora_service.shapes import adapter
from drivora_service.studies.comparing import Comparison


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
    comparison: Comparison = adapter(Comparison).validate_python(answer)
    return comparison
