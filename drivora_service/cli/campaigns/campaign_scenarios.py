"""The scenarios of a campaign's failures, for a suite."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from drivora_service.api.schemas.campaigns import Campaign, Failure
from drivora_service.client import Client
from drivora_service.oracles.verdicts.accountability import accountability
from drivora_service.oracles.verdicts.failure_definition import (
    Counted,
    FailureDefinition,
    definition_of,
)
from drivora_service.oracles.verdicts.failure_facts import failure_sentence
from drivora_service.scenario.documents import ScenarioDocument, parse_document
from drivora_service.store.campaigns.campaign_records import Confirmation
from drivora_service.suites.suite_exporting import FoundScenario, slug, tag


def find_failure_scenarios(
    client: Client,
    campaigns: Sequence[str],
    *,
    each: str,
    counted: Counted | None,
    most: int | None,
) -> Iterator[FoundScenario]:
    """Yields the scenarios of failures.

    Args:
        client: Client of the application or service that has the campaigns.
        campaigns: Their ids.
        each: ``kind``, ``group`` or ``failure``: one of each is taken, the first confirmed one.
        counted: Failures that are taken, and that count in the scenarios; ``None``: as the campaign
            counts.
        most: Greatest number of scenarios; ``None``: all.

    Raises:
        NotFound: There is no such campaign.
        ServiceError: The service refused or did not answer.
    """
    taken = 0
    for campaign_id in campaigns:
        campaign = client.campaign(campaign_id)
        definition = definition_of(campaign.document)
        if counted is not None:
            definition = replace(definition, counts=counted)
        failures = [
            one
            for one in client.failures(campaign_id)
            # A flaky one would not fail in the suite either.
            if one.confirmation is not Confirmation.FLAKY
            and definition.counts_degree(accountability(one.verdict))
        ]
        for failure, oracles in _choose_failures(failures, each):
            if most is not None and taken >= most:
                return
            taken += 1
            text = client.evaluation_scenario(campaign_id, failure.evaluation)
            document = parse_document(text, "json")
            yield _scenario(document, failure, oracles, campaign, definition)


def _choose_failures(
    failures: Sequence[Failure], each: str
) -> Iterator[tuple[Failure, tuple[str, ...]]]:
    """Yields one failure of each kind or group, with all oracles violated in its evaluation."""
    confirmed_first = sorted(
        failures, key=lambda one: (one.confirmation is not Confirmation.CONFIRMED, one.evaluation)
    )
    oracles: dict[int, dict[str, None]] = {}
    for one in confirmed_first:
        oracles.setdefault(one.evaluation, {})[one.verdict.oracle] = None
    seen: set[object] = set()
    for one in confirmed_first:
        key = {
            "kind": one.kind,
            "group": (one.verdict.oracle, one.kind if one.group is None else one.group),
            "failure": one.evaluation,
        }[each]
        if key not in seen:
            seen.add(key)
            yield one, tuple(oracles[one.evaluation])


def _scenario(
    document: ScenarioDocument,
    failure: Failure,
    oracles: tuple[str, ...],
    campaign: Campaign,
    definition: FailureDefinition,
) -> FoundScenario:
    town = document.map_region.town
    oracle, _, where = failure.kind.partition("|")
    place = where.partition("|")[0]
    sentence = failure_sentence(failure.verdict, town=town, kind=failure.kind)
    return FoundScenario(
        stem=slug((town, oracle, place)),
        document=document,
        tags=tuple(
            dict.fromkeys((tag(town), *map(tag, oracles), tag(f"found-by-{campaign.tester}")))
        ),
        definition=definition,
        comment=f"{sentence} Found by {campaign.tester} against {campaign.configuration}: "
        f"evaluation {failure.evaluation} of campaign {campaign.id}.",
    )
