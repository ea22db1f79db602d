"""Random testing."""

from __future__ import annotations

import numpy as np

from drivora_service.search.testers.random_search import RANDOM
from drivora_service.testing.tester_contract import TesterContract


class TestRandom(TesterContract):
    """The contract of testers."""

    plugin = RANDOM

    def test_it_reaches_the_whole_space(self) -> None:
        space = self.space()
        units = np.array(
            [space.to_unit(e.proposal.values) for e in self.play(self.create(), 400, 8)]
        )
        spread = units[:, space.varies]
        assert (spread.min(axis=0) <= 0.25).all()
        assert (spread.max(axis=0) >= 0.75).all()
