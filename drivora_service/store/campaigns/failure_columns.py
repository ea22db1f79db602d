"""The failures of campaigns in columns, for curves over hundreds of thousands of evaluations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import select
from sqlalchemy.orm import Session

from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaigns.campaign_records import Confirmation
from drivora_service.store.campaigns.campaign_repository import campaign_row
from drivora_service.store.campaigns.campaign_tables import EvaluationRow, FailureRow


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CampaignFindings:
    """The failures of a campaign, one row each, in the order of their evaluations.

    Failures that an identical run did not repeat are left out.

    Attributes:
        simulations: Candidates that count against the budget.
        budget: Simulations that the campaign may make.
        evaluation: (n,) numbers of the evaluations.
        simulation: (n,) simulations up to the evaluation, itself included.
        oracles: Names of the oracles, in the order in which they were first violated.
        oracle: (n,) places in ``oracles``.
        kinds: The kinds, in the order in which they were first found.
        kind: (n,) places in ``kinds``.
        avoidable: (n,) whether the ego was at fault and a careful and competent driver avoids it.
        flaky: Failures that were left out.
    """

    simulations: int
    budget: int
    evaluation: NDArray[np.int64]
    simulation: NDArray[np.int64]
    oracles: tuple[str, ...]
    oracle: NDArray[np.int64]
    kinds: tuple[str, ...]
    kind: NDArray[np.int64]
    avoidable: NDArray[np.bool_]
    flaky: int


def campaign_findings(session: Session, campaign_id: str) -> CampaignFindings:
    """Reads the failures of a campaign, finished or not.

    Raises:
        UnknownName: There is no such campaign.
    """
    campaign = campaign_row(session, campaign_id)
    # Of the table, not of the mapped class: reading takes half the time.
    failures = FailureRow.__table__.c
    query = (
        select(
            failures.number,
            failures.oracle,
            failures.kind,
            failures.accountability,
            failures.confirmation,
        )
        .where(failures.campaign_seq == campaign.seq)
        .order_by(failures.number, failures.place)
    )
    rows = session.execute(query).all()
    kept = [row for row in rows if row[4] != Confirmation.FLAKY]
    evaluation = np.array([row[0] for row in kept], dtype=np.int64)
    oracles, oracle = _number_names([row[1] for row in kept])
    kinds, kind = _number_names([row[2] for row in kept])
    invalid = np.sort(
        np.array(
            session.scalars(
                select(EvaluationRow.number).where(
                    EvaluationRow.campaign_seq == campaign.seq,
                    EvaluationRow.status == EvaluationStatus.INVALID,
                )
            ).all(),
            dtype=np.int64,
        )
    )
    return CampaignFindings(
        simulations=campaign.judged + campaign.failed,
        budget=campaign.budget,
        evaluation=evaluation,
        # Invalid candidates are evaluations, but not simulated.
        simulation=evaluation + 1 - np.searchsorted(invalid, evaluation),
        oracles=oracles,
        oracle=oracle,
        kinds=kinds,
        kind=kind,
        avoidable=np.array([row[3] == Accountability.AVOIDABLE for row in kept], dtype=np.bool_),
        flaky=len(rows) - len(kept),
    )


def _number_names(names: Sequence[str]) -> tuple[tuple[str, ...], NDArray[np.int64]]:
    """Returns the different names in their order, and the place of each name among them."""
    places = {name: place for place, name in enumerate(dict.fromkeys(names))}
    return tuple(places), np.array([places[name] for name in names], dtype=np.int64)
