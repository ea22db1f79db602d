"""Properties of every campaign document, valid or not."""

from __future__ import annotations

import json
from typing import Any

import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from drivora_service.campaigns.document.campaign import FeedbackMode
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_documents import campaign_text
from drivora_service.campaigns.document.campaign_reading import ValidCampaign, read_campaign
from drivora_service.errors import InvalidDocument
from drivora_service.oracles.verdicts.failure_definition import Counted
from tests.fuzzing.harness import check_refusal
from tests.scenario.conftest import GOOD
from tests.scenario.strategies import garbled, json_values, names, optional, texts

numbers = st.fixed_dictionaries(
    {},
    optional=optional(
        vehicles=st.integers(0, 4),
        walkers=st.integers(0, 4),
        obstacles=st.integers(0, 2),
        slices=st.integers(1, 50),
        reach=st.floats(10, 2000),
        paths=st.integers(1, 50),
        weather=st.booleans(),
        optional=st.booleans(),
        behavior=st.sampled_from(["replay", "reactive"]),
        max_speed_factor=st.floats(0.1, 3),
    ),
)
campaigns = st.fixed_dictionaries(
    {
        "name": names,
        "tester": st.fixed_dictionaries(
            {"name": st.sampled_from(["random", "avfuzzer", "behavexplor", "samota", "drivefuzz"])},
            optional=optional(feedback=st.sampled_from([str(mode) for mode in FeedbackMode])),
        ),
        "scenario": st.just(GOOD),
        "budget": st.fixed_dictionaries({"simulations": st.integers(1, 10**6)}),
    },
    optional=optional(
        agent=st.fixed_dictionaries(
            {"name": st.just("idm")},
            optional=optional(
                parameters=st.fixed_dictionaries({"speed_factor": st.floats(0.1, 2)})
            ),
        ),
        space=numbers,
        oracles=st.lists(
            st.sampled_from(["blocked", "collision", "red_light", "speeding"]),
            min_size=1,
            unique=True,
        ),
        counts=st.sampled_from(list(Counted)),
        seed=st.integers(0, 2**31 - 1),
        workers=st.integers(1, 8),
        lookahead=st.integers(1, 64),
    ),
)


def read(content: Any, catalogues: Catalogues, **language: Any) -> ValidCampaign | None:
    """Returns the campaign, or ``None`` after a check of the places of all problems."""
    try:
        return read_campaign(content, catalogues, **language)
    except InvalidDocument as error:
        check_refusal(error, content if isinstance(content, dict) else None)
        return None


@settings(max_examples=50)
@given(content=campaigns)
def test_valid_campaigns_survive_writing_and_reading(
    catalogues: Catalogues, content: dict[str, Any]
) -> None:
    first = read(content, catalogues)
    assert first is not None
    text = campaign_text(first.document)
    again = read(text, catalogues)
    assert again is not None
    assert (again.document, again.campaign, again.seeds) == (
        first.document,
        first.campaign,
        first.seeds,
    )
    assert campaign_text(again.document) == text
    other = read(yaml.safe_dump(json.loads(text)), catalogues, format="yaml")
    assert other is not None
    assert other.campaign == first.campaign


@settings(max_examples=100)
@given(content=garbled(campaigns.map(lambda made: json.loads(json.dumps(made)))))
def test_garbled_campaigns_are_read_or_refused(
    catalogues: Catalogues, content: dict[str, Any]
) -> None:
    read(content, catalogues)


@given(content=st.dictionaries(texts, json_values, max_size=4))
def test_any_object_is_refused_with_its_places(
    catalogues: Catalogues, content: dict[str, Any]
) -> None:
    assert read(content, catalogues) is None
