"""Jobs and batches: scenarios that are to be run."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Sequence
from typing import TYPE_CHECKING, Any, TypedDict

from drivora_service.api_paths import PREFIX
from drivora_service.client.call import (
    Call,
    Document,
    Language,
    Listing,
    Query,
    act,
    document_bytes,
    get,
    make_listing,
    post,
)

if TYPE_CHECKING:
    from drivora_service.api.schemas.batches import Batch, BatchSubmission
    from drivora_service.api.schemas.jobs import Job
    from drivora_service.api.schemas.service import Inspection, Validation
    from drivora_service.oracles.verdicts.failure_definition import Counted, FailureDefinition
    from drivora_service.store.runs.run_records import JobFilter, Priority, RunSummary
    from drivora_service.suites.paired.batch_comparison import BatchComparison
    from drivora_service.suites.paired.failure_rules import Unfinished


class PostOptions(TypedDict, total=False):
    """The options of the runs that :func:`post_job` and :func:`post_batch` queue."""

    agent: str
    agent_parameters: Sequence[str]
    seed: int | None
    definition: FailureDefinition | None


def validate_scenario(
    document: Document,
    *,
    language: Language = "json",
    agent: str = "",
    agent_parameters: Sequence[str] = (),
    seed: int | None = None,
) -> Call[Validation]:
    """Checks a scenario as posting it would; nothing is queued.

    Args:
        document: The scenario.
        language: Language of its text.
        agent: Drives every ego; "": as documented.
        agent_parameters: ``NAME=VALUE`` or ``EGO:NAME=VALUE``.
        seed: Overrides the document's.

    Raises:
        InvalidDocument: It cannot be run.
    """
    from drivora_service.api.schemas.service import Validation

    return post(
        f"{PREFIX}/scenarios:validate",
        Validation,
        document_bytes(document),
        language=language,
        query=_overrides(agent, agent_parameters, seed),
        only_checks=True,
    )


def inspect_scenario(document: Document, *, language: Language = "json") -> Call[Inspection]:
    """Returns the problems of a scenario, and its actors with their ways, valid or not.

    Args:
        document: The scenario.
        language: Language of its text.

    Raises:
        InvalidDocument: The text cannot be read at all.
    """
    from drivora_service.api.schemas.service import Inspection

    return post(
        f"{PREFIX}/scenarios:inspect",
        Inspection,
        document_bytes(document),
        language=language,
        only_checks=True,
    )


def post_job(
    document: Document,
    *,
    language: Language = "json",
    label: str = "",
    agent: str = "",
    agent_parameters: Sequence[str] = (),
    seed: int | None = None,
    definition: FailureDefinition | None = None,
) -> Call[Job]:
    """Queues a run of a scenario; returns its job.

    Args:
        document: The scenario.
        language: Language of its text.
        label: Display name.
        agent: Drives every ego; "": as documented.
        agent_parameters: ``NAME=VALUE`` or ``EGO:NAME=VALUE``.
        seed: Overrides the document's.
        definition: What is a failure of the run; ``None``: the default. What is known is left out.

    Raises:
        InvalidDocument: It cannot be run.
    """
    from drivora_service.api.schemas.jobs import Job

    return post(
        f"{PREFIX}/jobs",
        Job,
        document_bytes(document),
        language=language,
        query={
            "label": label,
            **_overrides(agent, agent_parameters, seed),
            **_counted(definition),
        },
    )


def jobs(wanted: JobFilter | None = None, *, limit: int | None = None) -> Listing[RunSummary]:
    """Returns jobs, newest first; at most ``limit``."""
    from drivora_service.store.runs.run_records import RunSummary

    return make_listing(f"{PREFIX}/jobs", RunSummary, limit, query=job_query(wanted))


def job(job_id: str) -> Call[Job]:
    """Returns where a job is, and why its run failed if it did."""
    from drivora_service.api.schemas.jobs import Job

    return get(f"{PREFIX}/jobs/{{job_id}}", Job, job_id=job_id)


def cancel_job(job_id: str) -> Call[Job]:
    """Cancels a job; a running one ends as soon as its worker has stopped it."""
    from drivora_service.api.schemas.jobs import Job

    return act(f"{PREFIX}/jobs/{{job_id}}:cancel", Job, job_id=job_id)


def post_batch(
    documents: Sequence[Document],
    *,
    labels: Sequence[str] | None = None,
    seeds: Sequence[int | None] | None = None,
    name: str = "",
    priority: Priority | None = None,
    agent: str = "",
    agent_parameters: Sequence[str] = (),
    seed: int | None = None,
    definition: FailureDefinition | None = None,
    definitions: Sequence[FailureDefinition] | None = None,
) -> Call[BatchSubmission]:
    """Queues a run of every scenario that can be run; returns what became of each.

    Args:
        documents: The scenarios, in JSON.
        labels: Display names of their runs, one for each scenario; ``None``: no names.
        seeds: Seeds of their runs, one for each scenario, for scenarios with labels; ``None``, and
            for each that is ``None``: ``seed``, or the document's.
        name: Display name.
        priority: Priority of the runs; ``None``: default of the service.
        agent: Drives every ego; "": as documented.
        agent_parameters: ``NAME=VALUE`` or ``EGO:NAME=VALUE``.
        seed: Overrides the documents'.
        definition: What is a failure of the runs; ``None``: the default. What is known is left out.
        definitions: What is a failure of each run, one for each scenario, for scenarios with
            labels; ``None``: the same for all.

    Raises:
        InvalidDocument: None of them can be run; pointers begin with the place of the scenario,
            such as ``/0``, or ``/0/scenario`` where there are labels. Pointers of rejected
            scenarios are into the scenario, or begin with ``/scenario``.
        ValueError: There are more or fewer labels, seeds or definitions than scenarios, or seeds or
            definitions and no labels.
    """
    from drivora_service.api.schemas.batches import BatchSubmission

    return post(
        f"{PREFIX}/batches",
        BatchSubmission,
        b"[" + b",".join(_batch_items(documents, labels, seeds, definitions)) + b"]",
        query={
            "name": name,
            "priority": priority,
            **_overrides(agent, agent_parameters, seed),
            **_counted(definition),
        },
    )


def batches(priorities: Collection[Priority] = (), *, limit: int | None = None) -> Listing[Batch]:
    """Returns batches with any of some priorities, or all; newest first; at most ``limit``."""
    from drivora_service.api.schemas.batches import Batch

    return make_listing(f"{PREFIX}/batches", Batch, limit, query={"priority": sorted(priorities)})


def batch(batch_id: str) -> Call[Batch]:
    """Returns how far a batch is."""
    from drivora_service.api.schemas.batches import Batch

    return get(f"{PREFIX}/batches/{{batch_id}}", Batch, batch_id=batch_id)


def compare_batches(
    a: str,
    b: str,
    *,
    counts: Counted | None = None,
    unfinished: Unfinished | None = None,
    oracles: Sequence[str] = (),
    metrics: Sequence[str] = (),
) -> Call[BatchComparison]:
    """Compares two batches on the same scenarios: failures, metrics, and every pair of runs.

    Args:
        a: Id of batch A, or its name: the newest batch of this name.
        b: Id or name of batch B.
        counts: The violations that are failures; ``None``: as defined where the runs were posted,
            unless oracles are named.
        unfinished: The runs without a judgement that are failures; ``None``: those that the ADS
            ended.
        oracles: The only oracles that count, observations included; empty: as ``counts`` says.
        metrics: Metrics to compare, and to show of each run; empty: all are compared, and the
            driving score is shown.
    """
    from drivora_service.suites.paired.batch_comparison import BatchComparison

    query = {
        "a": a,
        "b": b,
        "counts": counts,
        "unfinished": unfinished,
        "oracle": tuple(oracles),
        "metric": tuple(metrics),
    }
    return get(f"{PREFIX}/batches:compare", BatchComparison, query=query)


def cancel_batch(batch_id: str) -> Call[Batch]:
    """Cancels all runs of a batch that have not ended."""
    return _batch_act("cancel", batch_id)


def pause_batch(batch_id: str) -> Call[Batch]:
    """Starts no further run of a batch; its running runs continue."""
    return _batch_act("pause", batch_id)


def resume_batch(batch_id: str) -> Call[Batch]:
    """Starts the runs of a paused batch again."""
    return _batch_act("resume", batch_id)


def job_query(wanted: JobFilter | None) -> Query:
    """Returns the parameters that ask for jobs or runs."""
    from drivora_service.store.runs.run_records import JobFilter

    wanted = wanted or JobFilter()
    return {
        "batch": wanted.batch_id,
        "status": sorted(wanted.statuses),
        "agent": wanted.agent,
        "configuration": wanted.configuration_id,
        "town": wanted.town,
        "oracle": wanted.oracle,
        "outcome": wanted.outcome if wanted.oracle else None,
        "at_fault": wanted.at_fault,
        "accountability": wanted.accountability,
        "violated": wanted.violated,
        "failing": wanted.failing,
        "scenario_sha256": wanted.scenario_sha256,
        "campaign": wanted.campaign_id,
        "since": None if wanted.since is None else wanted.since.isoformat(),
        "until": None if wanted.until is None else wanted.until.isoformat(),
    }


def _batch_act(action: str, batch_id: str) -> Call[Batch]:
    from drivora_service.api.schemas.batches import Batch

    return act(f"{PREFIX}/batches/{{batch_id}}:{action}", Batch, batch_id=batch_id)


def _batch_items(
    documents: Sequence[Document],
    labels: Sequence[str] | None,
    seeds: Sequence[int | None] | None,
    definitions: Sequence[FailureDefinition] | None,
) -> Iterable[bytes]:
    beside: Sequence[tuple[str, Sequence[object] | None]] = (
        ("labels", labels),
        ("seeds", seeds),
        ("definitions", definitions),
    )
    if labels is None:
        for what, given in beside:
            if given is not None:
                raise ValueError(
                    f"found {what} for scenarios without labels; give each a label, too"
                )
        return map(document_bytes, documents)
    for what, given in beside:
        if given is not None and len(given) != len(documents):
            raise ValueError(
                f"found {len(given)} {what} for {len(documents)} scenarios; each needs one"
            )
    nothing = [None] * len(documents)
    return map(_encode_item, labels, documents, seeds or nothing, definitions or nothing)


def _encode_item(
    label: str, document: Document, seed: int | None, definition: FailureDefinition | None
) -> bytes:
    beside: dict[str, Any] = {"label": label}
    if seed is not None:
        beside["seed"] = seed
    if definition is not None:
        beside["failures"] = _posted(definition)
    return b'%b,"scenario":%b}' % (json.dumps(beside).encode()[:-1], document_bytes(document))


def _posted(definition: FailureDefinition) -> dict[str, Any]:
    """Returns a definition as an item of a batch has it."""
    content: dict[str, Any] = {"counts": definition.counts}
    if definition.oracles is not None:
        content["oracles"] = definition.oracles
    if definition.known:
        names = ("oracle", "ego", "counterpart", "agents")
        content["known"] = [
            {"reason": one.reason or "known"}
            | {name: getattr(one, name) for name in names if getattr(one, name)}
            for one in definition.known
        ]
    return content


def _counted(definition: FailureDefinition | None) -> Query:
    if definition is None:
        return {"counts": None, "count_oracle": ()}
    return {"counts": definition.counts, "count_oracle": definition.oracles or ()}


def _overrides(agent: str, agent_parameters: Sequence[str], seed: int | None) -> Query:
    return {"agent": agent, "agent_parameter": tuple(agent_parameters), "seed": seed}
