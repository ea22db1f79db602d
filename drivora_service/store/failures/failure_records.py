"""Failures of all campaigns and batches, as values."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.oracles.verdicts.failure_definition import Counted
from drivora_service.shapes import Shape
from drivora_service.store.campaigns.campaign_records import Confirmation


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundFilter:
    """A filter of failures of all campaigns and batches; defaults do not restrict.

    Attributes:
        oracle: Name of the oracle.
        group: Id of the group of the failure.
        at_fault: Whether an ego is at fault.
        accountability: Accountability of the ego.
        agent: ADS of the campaign or run.
        configuration_id: Id of the ADS with its parameters.
        town: Name of the road network.
        campaign_id: Campaign that found it.
        study_id: Study whose campaign found it.
        batch_id: Batch of the run, outside campaigns.
        confirmation: Whether an identical run repeated it; runs outside campaigns have none.
        counts: What counts in place of the definition of each run; ``None``: that definition,
            unless the filter asks for a degree of accountability or for fault.
        all_kept: Every failure that is kept, whatever counts.
        since: Found at this time or later.
        until: Found before this time.
    """

    oracle: str = ""
    group: str = ""
    at_fault: bool | None = None
    accountability: Accountability | None = None
    agent: str = ""
    configuration_id: str = ""
    town: str = ""
    campaign_id: str = ""
    study_id: str = ""
    batch_id: str = ""
    confirmation: Confirmation | None = None
    counts: Counted | None = None
    all_kept: bool = False
    since: datetime | None = None
    until: datetime | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundFailure(Shape):
    """A failure of a campaign, or a violation that counts of a run outside campaigns.

    Attributes:
        id: Grows with the time at which it was found.
        group_name: Oracle, relation of the other actor to the ego, and manoeuvre: the same on all
            road networks and in all campaigns.
        group_id: Id of its group: that of its name, unless a decision moved it to another.
        configuration: The ADS with the parameters that differ from its defaults.
        configuration_id: Short id of the ADS with all its parameters; empty if not recorded.
        accountability: null if it was judged before this was recorded.
        campaign_id: Campaign that found it; empty for a run outside campaigns.
        evaluation: Number of its evaluation; null outside campaigns.
        place: Its place among the failures of the evaluation, or among the verdicts of the run.
        kind: Its kind in the campaign; empty outside campaigns.
        confirmation: Whether an identical run repeated it; null outside campaigns.
        batch_id: Batch of the run; empty in campaigns, and for a job that was posted singly.
        run_id: Id of its run.
        is_recorded: Whether there is a recording of its run.
        avoidable_until: Last moment at which braking would have avoided it, simulation time in
            seconds; null if it was not avoidable, or that is not measurable.
        sentence: Its facts: parties, speed, manoeuvre, place, fault.
    """

    id: int
    found_at: datetime
    oracle: str
    group_name: str
    group_id: str
    agent: str
    configuration: str
    configuration_id: str
    town: str
    at_fault: bool | None
    accountability: Accountability | None
    campaign_id: str
    evaluation: int | None
    place: int
    kind: str
    confirmation: Confirmation | None
    batch_id: str
    run_id: str
    is_recorded: bool
    avoidable_until: float | None
    sentence: str
    verdict: Verdict
