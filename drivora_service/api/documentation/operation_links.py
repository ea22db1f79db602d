"""Links of the OpenAPI document: which operations take what an answer names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from drivora_service.api_paths import PREFIX


@dataclass(frozen=True, slots=True, kw_only=True)
class _Link:
    """Operations that take a value of an answer.

    Attributes:
        source: Method and path of the operation that answers.
        values: Places of the parameters' values in the answer, by the parameter's name.
        targets: Methods and paths of those that take them.
    """

    source: str
    values: Mapping[str, str]
    targets: tuple[str, ...]


_RUN = (
    "GET /runs/{run_id}",
    "GET /runs/{run_id}/scenario",
    "GET /runs/{run_id}/observations",
    "GET /runs/{run_id}/timeline",
    "GET /runs/{run_id}/series",
    "GET /runs/{run_id}/perception",
)
_JOB = ("GET /jobs/{job_id}", "POST /jobs/{job_id}:cancel")
_BATCH = (
    "GET /batches/{batch_id}",
    "POST /batches/{batch_id}:pause",
    "POST /batches/{batch_id}:resume",
    "POST /batches/{batch_id}:cancel",
)
_CAMPAIGN = (
    "GET /campaigns/{campaign_id}",
    "GET /campaigns/{campaign_id}/evaluations",
    "GET /campaigns/{campaign_id}/failures",
    "GET /campaigns/{campaign_id}/figures",
    "POST /campaigns/{campaign_id}:pause",
    "POST /campaigns/{campaign_id}:resume",
    "POST /campaigns/{campaign_id}:cancel",
)
_EVALUATION = (
    "GET /campaigns/{campaign_id}/evaluations/{number}",
    "GET /campaigns/{campaign_id}/evaluations/{number}/scenario",
    "GET /campaigns/{campaign_id}/evaluations/{number}/observations",
)
_STUDY = (
    "GET /studies/{study_id}",
    "GET /studies/{study_id}/comparison",
    "POST /studies/{study_id}:pause",
    "POST /studies/{study_id}:resume",
    "POST /studies/{study_id}:cancel",
)
_NETWORK = ("GET /networks/{name}", "GET /networks/{name}/geometry")
_THIS_CAMPAIGN = {"campaign_id": "$request.path.campaign_id"}


def _body(pointer: str) -> str:
    return f"$response.body#{pointer}"


_LINKS = (
    _Link(source="POST /jobs", values={"job_id": _body("/id")}, targets=_JOB),
    _Link(source="POST /jobs", values={"run_id": _body("/id")}, targets=_RUN),
    _Link(source="GET /jobs", values={"job_id": _body("/items/0/id")}, targets=_JOB),
    _Link(source="GET /runs", values={"run_id": _body("/items/0/id")}, targets=_RUN),
    _Link(source="POST /batches", values={"batch_id": _body("/batch/id")}, targets=_BATCH),
    _Link(source="POST /batches", values={"job_id": _body("/items/0/job_id")}, targets=(_JOB[0],)),
    _Link(source="GET /batches", values={"batch_id": _body("/items/0/id")}, targets=_BATCH),
    _Link(source="POST /campaigns", values={"campaign_id": _body("/id")}, targets=_CAMPAIGN),
    _Link(source="GET /campaigns", values={"campaign_id": _body("/items/0/id")}, targets=_CAMPAIGN),
    _Link(
        source="GET /campaigns/{campaign_id}/evaluations",
        values={**_THIS_CAMPAIGN, "number": _body("/items/0/number")},
        targets=_EVALUATION,
    ),
    _Link(
        source="GET /campaigns/{campaign_id}/failures",
        values={**_THIS_CAMPAIGN, "number": _body("/items/0/evaluation")},
        targets=_EVALUATION,
    ),
    _Link(source="POST /studies", values={"study_id": _body("/id")}, targets=_STUDY),
    _Link(source="GET /studies", values={"study_id": _body("/items/0/id")}, targets=_STUDY),
    _Link(source="POST /networks", values={"name": _body("/name")}, targets=_NETWORK),
    _Link(source="GET /networks", values={"name": _body("/items/0/name")}, targets=_NETWORK),
    *(
        _Link(source=f"GET {path}", values={"page_token": _body("/next_page_token")}, targets=())
        for path in ("/jobs", "/runs", "/batches", "/campaigns", "/studies")
    ),
    *(
        _Link(
            source=f"GET /campaigns/{{campaign_id}}/{items}",
            values={**_THIS_CAMPAIGN, "page_token": _body("/next_page_token")},
            targets=(),
        )
        for items in ("evaluations", "failures")
    ),
)


def add_links(paths: dict[str, Any]) -> None:
    """Adds the links to the paths of an OpenAPI document.

    A link without targets is one from a page of a list to the next page.
    """
    for link in _LINKS:
        source = _operation(paths, link.source)
        status = next(status for status in ("202", "201", "200") if status in source["responses"])
        links = source["responses"][status].setdefault("links", {})
        for target in link.targets or (link.source,):
            operation_id = _operation(paths, target)["operationId"]
            name = "next page" if not link.targets else target.replace("/", " ").strip()
            links["".join(c for c in name.title() if c.isalnum())] = {
                "operationId": operation_id,
                "parameters": dict(link.values),
            }


def _operation(paths: dict[str, Any], name: str) -> dict[str, Any]:
    method, path = name.split(" ")
    operation: dict[str, Any] = paths[PREFIX + path][method.lower()]
    return operation
