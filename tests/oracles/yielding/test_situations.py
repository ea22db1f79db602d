"""The oracle finds the actors that an ego hinders, and no others, in situations with known answers.

The answers were written down from traces and pictures, before the oracle judged them.
"""

from __future__ import annotations

import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.observations.run_view import RunView
from drivora_service.oracles.failure_to_yield import FailureToYield
from drivora_service.oracles.verdict import Outcome
from drivora_service.scenario.validation import validate_document
from tests.oracles.responsibility.judged import record
from tests.oracles.responsibility.ways import town
from tests.oracles.yielding.families import all_situations
from tests.oracles.yielding.known_answers import ANSWERS
from tests.oracles.yielding.situation import Situation

SITUATIONS = all_situations()


@pytest.mark.slow(seconds=1)
@pytest.mark.parametrize("situation", SITUATIONS, ids=lambda situation: situation.name)
def test_the_known_answer(situation: Situation) -> None:
    run = RunView(record(situation.document()), town(situation.case.town))
    verdicts = [v for v in FailureToYield().judge(run) if v.ego == run.egos[0].id]
    hindered = [v.counterpart for v in verdicts if v.outcome is Outcome.VIOLATED]
    assert sorted(hindered) == sorted(ANSWERS[situation.name].hindered)


def test_there_are_enough_of_each_answer_and_every_document_is_valid() -> None:
    names = [situation.name for situation in SITUATIONS]
    assert len(set(names)) == len(names)
    assert set(names) == set(ANSWERS)
    hindering = [name for name in names if ANSWERS[name].hindered]
    assert len(hindering) >= 30
    assert len(names) - len(hindering) >= 30
    agents, networks = AgentCatalogue().availability(), NetworkCatalogue(shipped_networks())
    for situation in SITUATIONS:
        validate_document(situation.document(), networks, agents)
