"""The contract of gene spaces, as a suite of tests for authors of spaces.

Derive a class whose name begins with ``Test`` and give it the plug-in::

    class TestMySpace(SpaceContract):
        plugin = MY_PLUGIN

A space that needs another seed scenario than a straight stretch of a shipped town overrides
:meth:`SpaceContract.seed`.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import pytest

from drivora_service.errors import SearchError
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.canonical import canonical_json, from_canonical
from drivora_service.scenario.check_warm_up import warm_up_checks
from drivora_service.scenario.model import Scenario
from drivora_service.scenario.validation import scenario_problems
from drivora_service.search.candidate_space import OwnSpace, SpacePlugin
from drivora_service.search.space.own_space import PluginSpace


class SpaceContract:
    """Tests that every space of a package passes.

    Attributes:
        plugin: The space under test.
        parameters: Parameters that differ from their defaults.
        valid_share: Least share of drawn candidates that must be valid scenarios. A campaign does
            not simulate the others, and ends if there are more of them than its budget.
    """

    # Because of its name, pytest would collect it wherever it is imported.
    __test__ = False

    plugin: ClassVar[SpacePlugin[Any]]
    parameters: ClassVar[dict[str, Any]] = {}
    valid_share: ClassVar[float] = 0.5

    def __init_subclass__(cls) -> None:
        """Marks derived classes as suites."""
        super().__init_subclass__()
        cls.__test__ = True

    def seed(self) -> Scenario:
        """Returns the seed scenario."""
        return warm_up_checks(NetworkCatalogue(shipped_networks()))

    def create(self) -> PluginSpace:
        """Makes the space of the seed scenario."""
        seed = self.seed()
        network = NetworkCatalogue(shipped_networks()).get(seed.map_region.town)
        choice = OwnSpace(plugin=self.plugin.name, parameters=self.parameters)
        return PluginSpace(seed, network, choice, self.plugin)

    def drawn(self, space: PluginSpace, count: int = 30) -> FloatArray:
        """Draws candidates: (count, d)."""
        return space.genes.sample(np.random.default_rng(5), count)

    def test_the_same_parameters_give_the_same_genes(self) -> None:
        one, other = self.create().genes, self.create().genes
        assert one.names == other.names
        assert len(set(one.names)) == len(one)
        assert one.genes == other.genes
        assert one.varies.any()

    def test_repairing_again_changes_nothing(self) -> None:
        space = self.create()
        for values in self.drawn(space):
            before = values.copy()
            repaired = space.repair(values)
            assert np.array_equal(values, before), "values that are given must stay as they are"
            assert np.array_equal(space.repair(repaired), repaired)

    def test_the_same_values_are_the_same_scenario_in_every_process(self) -> None:
        space, other = self.create(), self.create()
        for values in self.drawn(space):
            repaired = space.repair(values)
            text = canonical_json(space.scenario(repaired))
            assert canonical_json(space.scenario(repaired)) == text
            assert canonical_json(other.scenario(other.repair(values))) == text

    def test_most_candidates_are_valid_scenarios(self) -> None:
        space = self.create()
        networks = NetworkCatalogue(shipped_networks())
        agents = {ego.agent.name for ego in space.seed.ego_vehicles}
        problems = []
        drawn = self.drawn(space)
        for values in drawn:
            scenario = space.scenario(space.repair(values))
            problems += [scenario_problems(scenario, networks, agents)]
            if not problems[-1]:
                # What is stored and run is the text.
                assert canonical_json(from_canonical(canonical_json(scenario)))
        valid = sum(not found for found in problems)
        assert valid >= self.valid_share * len(drawn), [found for found in problems if found][:3]

    def test_genes_change_the_scenario(self) -> None:
        space = self.create()
        texts = {canonical_json(space.scenario(space.repair(row))) for row in self.drawn(space)}
        assert len(texts) > 1

    def test_the_bounds_can_be_decoded(self) -> None:
        space = self.create()
        for values in (space.genes.lows, space.genes.highs):
            assert isinstance(space.scenario(space.repair(values)), Scenario)

    def test_unknown_parameters_are_refused(self) -> None:
        seed = self.seed()
        network = NetworkCatalogue(shipped_networks()).get(seed.map_region.town)
        choice = OwnSpace(plugin=self.plugin.name, parameters={"no such parameter": 1})
        with pytest.raises(SearchError, match="no such parameter"):
            PluginSpace(seed, network, choice, self.plugin)
