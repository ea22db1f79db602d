"""Starting a minimisation: which violation of a run is followed, and what the run has driven."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from drivora_service.errors import Conflict
from drivora_service.oracles.verdict import Outcome
from drivora_service.oracles.verdicts.failure_definition import FailureDefinition
from drivora_service.oracles.verdicts.failure_identity import gravest, identity_of
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.minimizations.minimization_records import NewMinimization
from drivora_service.store.runs.run_records import RunRecord
from drivora_service.suites.minimization.changed_software import find_missing

DEFAULT_BUDGET = 500
"""Simulations that a search may need."""


def new_minimization(
    run: RunRecord,
    text: str,
    *,
    overrides: tuple[str, int | None],
    definition: FailureDefinition,
    oracle: str,
    radius_m: float,
    budget: int,
    owner_id: str,
    oracles: Collection[str],
    known_agents: Mapping[str, str],
) -> NewMinimization:
    """Returns the minimisation of a run.

    Args:
        run: A run with a violation.
        text: Canonical JSON of its scenario.
        overrides: Agent and seed that override those of the scenario.
        definition: What counts as a failure of the run.
        oracle: Oracle whose violation is followed, whether it counts or not; "": that of the
            gravest failure.
        radius_m: Metres within which a violation is at the same place.
        budget: Simulations that the search may need.
        owner_id: Process of a command that will run it; "": any service.
        oracles: Names of the oracles that judge runs here.
        known_agents: Why an agent cannot be used here, by its name; "": it can.

    Raises:
        Conflict: The run has no violation to follow, or what it needs to fail again is not
            installed.
    """
    # Imported here: it needs the compiler of kernels.
    from drivora_service.scenario.documents import document_text
    from drivora_service.suites.minimization.proposal_checking import document_of_run

    agents = {ego: choice.name for ego, choice in run.agents.items()}
    violation = gravest(run.verdicts, definition, agents, oracle=oracle)
    if violation is None:
        raise Conflict(_nothing_to_follow(run, definition, oracle))
    missing = find_missing(run, violation.oracle, oracles=oracles, agents=known_agents)
    if missing:
        raise Conflict(f"run {run.id} cannot fail again here: {'; '.join(missing)}")
    agent, seed = overrides
    return NewMinimization(
        run_id=run.id,
        failure=identity_of(violation, radius_m=radius_m),
        budget=budget,
        document=document_text(document_of_run(text, agent=agent, seed=seed)),
        owner_id=owner_id,
    )


def _nothing_to_follow(run: RunRecord, definition: FailureDefinition, oracle: str) -> str:
    if run.status is not RunStatus.FINISHED:
        return (
            f"run {run.id} is {run.status} and has no verdicts; a finished run with a violation "
            "can be minimised"
        )
    violated = sorted({v.oracle for v in run.verdicts if v.outcome is Outcome.VIOLATED})
    found = f"it violates {', '.join(violated)}" if violated else "it violates no oracle"
    if oracle:
        return f"run {run.id} does not violate {oracle}; {found}"
    if violated:
        return (
            f"run {run.id} has no failure, which are {definition}; {found}. Name one of these as "
            "the oracle to minimise what does not count"
        )
    return f"run {run.id} has no violation to follow; choose a run that fails"
