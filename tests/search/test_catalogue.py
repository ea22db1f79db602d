"""Testers by name, built in and from installed packages, and the parameters that they take."""

from __future__ import annotations

import importlib
import textwrap
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pytest
from pydantic import Field

from drivora_service.errors import SearchError, UnknownName
from drivora_service.parameters import read_parameters
from drivora_service.search.catalogue import BUILT_IN, TesterCatalogue, make_components
from drivora_service.search.components import Components
from drivora_service.search.tester import TesterContext
from drivora_service.search.testers.random_search import RandomTester
from drivora_service.testing.gene_spaces import small_space

PACKAGE = """
from dataclasses import replace

from drivora_service.search.plugin import MutationPlugin
from drivora_service.search.testers.random_search import RANDOM


class Nothing:
    def mutate(self, values, space, random, *, strength=1.0):
        return values.copy()


chance = replace(RANDOM, name="chance")
other_name = replace(RANDOM, name="other")
not_a_plugin = Nothing
nothing = MutationPlugin(name="nothing", description="changes nothing", create=Nothing)
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """Parameters of every kind."""

    rate: Annotated[float, Field(ge=0.0, le=1.0)] = 0.5
    size: int = 4
    names: tuple[str, ...] = ()
    on: bool = False


@pytest.fixture
def installed_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A distribution that brings testers, as an installer would have left it."""
    (tmp_path / "chance_testers.py").write_text(textwrap.dedent(PACKAGE))
    info = tmp_path / "chance_testers-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: chance-testers\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[drivora_service.testers]\n"
        "chance = chance_testers:chance\n"
        "misnamed = chance_testers:other_name\n"
        "broken = chance_testers:not_a_plugin\n"
        "gone = chance_testers_that_are_gone:plugin\n"
        "random = chance_testers:other_name\n"
        "[drivora_service.mutations]\n"
        "nothing = chance_testers:nothing\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    importlib.invalidate_caches()


def context() -> TesterContext:
    return TesterContext(space=small_space(), random=np.random.default_rng(0), budget=10)


def test_the_built_in_testers_are_complete_and_have_names_of_their_own() -> None:
    names = [plugin.name for plugin in BUILT_IN]
    assert list(TesterCatalogue().names()) == sorted(set(names))
    assert len(names) == len(set(names))
    for plugin in BUILT_IN:
        assert plugin.title
        assert plugin.description
        assert plugin.source
        assert plugin.parameters() == read_parameters(plugin.parameters, {}, of="tester")


def test_an_unknown_name_is_reported_with_the_known_ones() -> None:
    with pytest.raises(UnknownName, match=r"tester 'chaos'.*random"):
        TesterCatalogue().create("chaos", context(), {}, Components())
    with pytest.raises(UnknownName, match="mutation 'chaos'"):
        make_components(mutation="chaos")
    with pytest.raises(UnknownName, match="selection 'chaos'"):
        make_components(selection="chaos")


def test_what_a_campaign_does_not_name_is_left_to_the_tester() -> None:
    assert make_components() == Components()


def test_a_tester_takes_no_parameter_that_it_does_not_have() -> None:
    with pytest.raises(SearchError, match="tester 'random' has no parameter 'speed'"):
        TesterCatalogue().create("random", context(), {"speed": 1}, Components())


def test_parameters_that_are_not_set_keep_their_defaults() -> None:
    read = read_parameters(Sample, {"rate": 1, "names": ["a", "b"]}, of="sample")
    assert read == Sample(rate=1.0, names=("a", "b"))


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"pace": 1}, r"sample has no parameter 'pace'; known: rate, size, names, on"),
        ({"rate": 1.5}, r"rate is 1\.5; allowed: a number from 0 to 1"),
        ({"rate": "0.5"}, r"rate is \"0\.5\"; allowed: a number"),
        ({"rate": float("nan")}, "finite"),
        ({"size": 2.5}, r"size is 2\.5; allowed: an integer"),
        ({"size": True}, r"size is true; allowed: an integer"),
        ({"on": 1}, r"on is 1; allowed: true or false"),
        ({"names": ["a", 1]}, r"names\.1 is 1; allowed: a list, each of it text"),
        ({"names": {1, 2}}, "JSON"),
    ],
)
def test_a_parameter_that_is_not_allowed_is_told_with_its_value(
    parameters: dict[str, Any], message: str
) -> None:
    with pytest.raises(SearchError, match=message):
        read_parameters(Sample, parameters, of="sample")


@pytest.mark.usefixtures("installed_package")
def test_an_installed_package_brings_a_tester_and_a_mutation() -> None:
    assert "chance" in TesterCatalogue().names()
    made = TesterCatalogue().create("chance", context(), {}, Components())
    assert isinstance(made, RandomTester)
    mutation = make_components(mutation="nothing").mutation
    assert mutation is not None
    space = small_space()
    values = space.sample(np.random.default_rng(1))
    assert np.array_equal(mutation.mutate(values, space, np.random.default_rng(2)), values)


@pytest.mark.usefixtures("installed_package")
def test_a_package_does_not_replace_a_built_in_tester() -> None:
    assert TesterCatalogue().plugin("random").name == "random"


@pytest.mark.usefixtures("installed_package")
@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("broken", "is a type; allowed: TesterPlugin"),
        ("gone", "cannot be loaded: ModuleNotFoundError"),
        ("misnamed", "is the tester 'other'"),
    ],
)
def test_a_broken_plug_in_is_reported_and_affects_no_other(name: str, message: str) -> None:
    catalogue = TesterCatalogue()
    with pytest.raises(SearchError, match=message):
        catalogue.plugin(name)
    assert catalogue.plugin("chance").name == "chance"
