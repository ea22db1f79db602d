"""Gene spaces of installed packages: from a campaign's file to candidates in workers."""

from __future__ import annotations

import copy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_documents import (
    CampaignDocument,
    SpaceDocument,
    campaign_text,
)
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.search.search_preparation import prepare_search
from drivora_service.errors import InvalidDocument, SearchError
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.runs.candidate import CandidateSource
from drivora_service.scenario.canonical import from_canonical
from drivora_service.scenario.model import Scenario
from drivora_service.search.candidate_space import SpacePlugin
from drivora_service.search.genes import GeneSpace, Part
from drivora_service.search.space.layout import Layout, number
from drivora_service.search.space.own_space import make_space, space_plugins
from drivora_service.search.space.source import source_of, space_of
from drivora_service.testing.space_contract import SpaceContract
from drivora_service.worker.candidate_preparing import prepare
from drivora_service.worker.setup import WorkerSetup
from tests.installed_parts import install_parts, uninstall_parts
from tests.search.space.seeds import NETWORKS

# What is installed imports it from here: the same classes.
PARTS = "[drivora_service.spaces]\nfog = tests.search.space.test_own_space:FOG\n"


@dataclass(frozen=True, kw_only=True)
class Parameters:
    """Parameters of the space; ``mistake`` makes it do something wrong."""

    thickest: float = 90.0
    mistake: str = ""


class Fog:
    """The fog varies, in whole percent."""

    def __init__(self, seed: Scenario, _network: RoadNetwork, parameters: Parameters) -> None:
        if parameters.thickest > 100.0:
            raise ValueError("thicker than thick")
        self._seed, self._mistake = seed, parameters.mistake
        layout = Layout()
        genes = [number("fog_density", 0.0, parameters.thickest, "%")]
        layout.add("weather", Part.WEATHER, genes)
        self.genes = GeneSpace(layout.blocks)

    def repair(self, values: FloatArray) -> FloatArray:
        return np.floor(values) if self._mistake != "repair" else values + 1e3

    def scenario(self, values: FloatArray) -> Any:
        if self._mistake == "raise":
            raise KeyError("no weather")
        if self._mistake == "type":
            return {}
        (density,) = values.tolist()
        return replace(self._seed, weather=replace(self._seed.weather, fog_density=density))


FOG = SpacePlugin(name="fog", description="fog", parameters=Parameters, create=Fog)


class TestFog(SpaceContract):
    plugin = FOG


@pytest.fixture(autouse=True)
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    install_parts(tmp_path / "site", monkeypatch, parts=PARTS)
    return tmp_path / "site"


def content(space: object, **changes: Any) -> dict[str, Any]:
    return {
        "name": "fog",
        "tester": {"name": "random"},
        "scenario": copy.deepcopy(SCENARIO),
        "space": space,
        "budget": {"simulations": 4},
        **changes,
    }


def test_workers_decode_what_the_campaign_proposes(catalogues: Catalogues) -> None:
    space = {"name": "fog", "parameters": {"thickest": 50.0}}
    valid = read_campaign(content(space), catalogues)
    assert valid.versions["own-parts"] == "0.1"
    stored = CampaignDocument.model_validate_json(campaign_text(valid.document))
    assert stored == valid.document
    assert stored.space.model_dump(mode="json") == space
    search = prepare_search(valid, catalogues, run_prefix="")
    (part,) = search.parts
    (proposal,) = part.tester.ask(1)
    source = CandidateSource(space=part.candidates.source, values=tuple(proposal.values.tolist()))
    candidate = prepare(source, WorkerSetup(shipped_networks=shipped_networks()))
    assert candidate.problem == ""
    assert candidate.values == (np.floor(proposal.values[0]),)
    assert from_canonical(candidate.document).weather.fog_density == candidate.values[0] <= 50.0
    assert candidate == replace(
        part.candidates.prepare(proposal.values), prepare_s=candidate.prepare_s
    )


@pytest.mark.parametrize(
    ("mistake", "message"),
    [
        ("raise", "space 'fog' raised KeyError when it was asked to decode values: 'no weather'"),
        ("type", "decoded values to a dict; a Scenario is needed"),
        ("repair", "not within the bounds of its 1 genes"),
    ],
)
def test_a_mistake_of_the_package_makes_the_candidate_invalid(
    mistake: str, message: str, catalogues: Catalogues
) -> None:
    space = {"name": "fog", "parameters": {"mistake": mistake}}
    search = prepare_search(read_campaign(content(space), catalogues), catalogues, run_prefix="")
    candidate = search.parts[0].candidates.prepare(np.array([7.5]))
    assert message in candidate.problem
    assert candidate.document == ""


@pytest.mark.parametrize(
    ("space", "pointer", "message"),
    [
        ({"name": "frog"}, "/space/name", "did you mean 'fog'"),
        ({"name": "fog", "parameters": {"thick": 1}}, "/space/parameters/thick", "'thickest'"),
        ({"name": "fog", "vehicles": 2}, "/space", "found `vehicles` beside `name`"),
        ({"name": "fog", "preset": "avfuzzer"}, "/space", "beside `name`"),
        ({"parameters": {}}, "/space", "found `parameters` without `name`"),
        ({"name": "fog", "parameters": {"thickest": 101.0}}, "/space", "raised ValueError"),
    ],
)
def test_what_is_wrong_is_named_with_its_place(
    space: dict[str, Any], pointer: str, message: str, catalogues: Catalogues
) -> None:
    with pytest.raises(InvalidDocument) as caught:
        prepare_search(read_campaign(content(space), catalogues), catalogues, run_prefix="")
    found = {one.pointer: one.message for one in caught.value.problems}
    assert message in found[pointer]


def test_without_its_package_a_space_says_so(site: Path, catalogues: Catalogues) -> None:
    valid = read_campaign(content({"name": "fog"}), catalogues)
    seed = valid.seeds[0]
    source = source_of(make_space(seed.scenario, seed.network, valid.campaign.space))
    assert space_of(source, NETWORKS).genes.names == ("weather.fog_density",)
    uninstall_parts(site)
    assert "fog" not in space_plugins().names()
    with pytest.raises(SearchError, match="space 'fog' is of a package that is not installed"):
        space_of(source, NETWORKS)


def test_the_built_in_space_is_stored_as_before() -> None:
    stored = SpaceDocument().model_dump(mode="json")
    assert "name" not in stored
    assert "parameters" not in stored
    assert SpaceDocument.model_validate(stored) == SpaceDocument()
