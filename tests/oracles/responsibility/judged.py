"""Cases of responsibility, run by the real simulation and judged."""

from __future__ import annotations

from functools import lru_cache

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Trace
from drivora_service.oracles.collision import Collision
from drivora_service.oracles.verdict import Verdict
from drivora_service.scenario.conversion import to_scenario
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.planning import plan_episode
from tests.oracles.responsibility.case import AT_FAULT, NOT_AT_FAULT, UNDETERMINED, Case
from tests.oracles.responsibility.families import all_cases
from tests.oracles.responsibility.ways import town


def recorded(case: Case) -> Trace:
    """Runs a case to its end."""
    return record(case.document())


def record(document: ScenarioDocument) -> Trace:
    """Runs a scenario on a shipped network to its end."""
    network = town(document.map_region.town)
    scenario = to_scenario(document, network)
    catalogue = AgentCatalogue()
    team = [catalogue.create(ego.agent.name, ego.agent.parameters) for ego in scenario.ego_vehicles]
    episode = Episode(plan_episode(scenario, network), team)
    while not episode.done:
        episode.step()
    return episode.finish()


@lru_cache(maxsize=512)
def collisions(name: str) -> dict[str, Verdict]:
    """The collision verdict of every ego of a case, by the ego's id."""
    case = next(case for case in all_cases() if case.name == name)
    verdicts = Collision().judge(RunView(recorded(case), town(case.town)))
    assert len({verdict.ego for verdict in verdicts}) == len(verdicts), "one collision an ego"
    return {verdict.ego: verdict for verdict in verdicts}


def fault(verdict: Verdict) -> str:
    """What a collision's verdict says of responsibility."""
    if verdict.undetermined:
        return UNDETERMINED
    return {True: AT_FAULT, False: NOT_AT_FAULT, None: "no collision"}[verdict.at_fault]
