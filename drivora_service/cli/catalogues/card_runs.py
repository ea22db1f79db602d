"""``drivora agents benchmark``: the runs and their pictures."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.benchmarking.benchmark_run import BenchmarkRun
from drivora_service.benchmarking.card import AgentCard, card_of
from drivora_service.benchmarking.card_courses import BenchmarkScenario
from drivora_service.cli.terminal.output import find_entry, number, print_table, say
from drivora_service.cli.terminal.trace_drawing import draw_trace
from drivora_service.client import Client
from drivora_service.scenario.documents import document_text
from drivora_service.settings import Settings
from drivora_service.shapes import combine

_MOMENTS = 5
"""Pictures in the strip of a card."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Entrants:
    """The agents of a benchmark.

    Attributes:
        present: Those that can drive.
        absent: Those that were named and cannot, with the reason.
    """

    present: tuple[AgentEntry, ...]
    absent: tuple[AgentEntry, ...]


def find_entrants(client: Client, names: Sequence[str]) -> Entrants:
    """Looks agents up, each once; without names, all that there are.

    Raises:
        UnknownName: There is no agent of a name.
    """
    agents = client.agents().items
    wanted = dict.fromkeys(names or (agent.name for agent in agents))
    entries = [
        combine(AgentEntry, agent, kind=AgentKind(agent.kind))
        for agent in (find_entry("agent", name, agents) for name in wanted)
    ]
    return Entrants(
        present=tuple(entry for entry in entries if entry.installed),
        absent=tuple(entry for entry in entries if not entry.installed),
    )


def benchmark(
    client: Client,
    agents: Sequence[AgentEntry],
    scenarios: Sequence[BenchmarkScenario],
    *,
    on_run: Callable[[AgentEntry], None],
) -> tuple[AgentCard, ...]:
    """Lets agents drive the benchmark: one batch an agent.

    Args:
        client: Client of the application or service that runs them.
        agents: Can be used.
        scenarios: The scenarios that each agent drives.
        on_run: Called with the agent of each run that has ended.

    Returns:
        Their cards in the order of the agents.

    Raises:
        InvalidDocument: The service does not accept a scenario.
        ServiceError: The service refused, did not answer, or cannot begin runs.
    """
    documents = [document_text(scenario.document) for scenario in scenarios]
    labels = [scenario.name for scenario in scenarios]
    # All of them are queued before the first is waited for, so that no worker is idle in between.
    batches = [
        client.post_batch(
            documents, labels=labels, name=f"benchmark {agent.name}", agent=agent.name
        ).batch
        for agent in agents
    ]
    cards = []
    for agent, batch in zip(agents, batches, strict=True):
        runs = []
        for run in client.wait_for_batch(batch.id):
            scenario = scenarios[run.item]
            runs.append(BenchmarkRun(network=scenario.network, number=scenario.number, record=run))
            on_run(agent)
        cards.append(card_of(agent, runs))
    return tuple(cards)


def draw_cards(
    client: Client, cards: Iterable[AgentCard], out: Path, settings: Settings
) -> dict[str, Path]:
    """Draws the shown run of each card.

    Args:
        client: Client of the application or service that ran them.
        cards: The cards.
        out: Existing folder for the pictures.
        settings: Settings with the folder of imported networks.

    Returns:
        The pictures by agent.

    Raises:
        ServiceError: A trace could not be fetched.
    """
    pictures = {}
    with tempfile.TemporaryDirectory(prefix="drivora-") as scratch:
        for card in cards:
            if card.shown is not None:
                name = card.agent.name
                trace, pictures[name] = Path(scratch) / "shown.parquet", out / f"{name}.png"
                client.save_run_observations(trace, card.shown.record.id)
                draw_trace(trace, settings, pictures[name], moments=_MOMENTS)
    return pictures


def print_cards(cards: Sequence[AgentCard], absent: Sequence[AgentEntry]) -> None:
    """Prints a row an agent, and below it why runs were not judged and agents were not run."""
    if cards:
        print_table("", _COLUMNS, map(_row, cards))
    if any(card.agent.privileged for card in cards):
        say("* sees everything, not only what the perception model lets through")
    for card in cards:
        for failure in card.failures:
            say(
                f"{card.agent.name}: {failure.cause or failure.status} in {failure.runs} run(s), "
                f"{failure.example_run}: {failure.example}"
            )
    for agent in absent:
        say(f"{agent.name} was not run: {agent.reason}")


_COLUMNS = (
    "agent",
    "arrived",
    "crashed",
    "at\nfault",
    "avoid-\nable",
    "red\nlights",
    "score\n(%)",
    "comfort\n(0-1)",
    "step\n(ms)",
    "agent\n(ms)",
)
"""Two lines where one would make the table wider than a terminal."""


def _row(card: AgentCard) -> tuple[str, ...]:
    total = card.total
    cost, own = total.step_cost_median_us, total.agent_cost_median_us
    return (
        card.agent.name + ("*" if card.agent.privileged else ""),
        f"{total.arrivals}/{total.runs}",
        str(total.collisions),
        str(total.at_fault_collisions),
        str(total.avoidable_collisions),
        str(total.red_lights),
        number(total.driving_score),
        number(total.comfort, 2),
        number(None if cost is None else cost / 1000.0, 2),
        number(None if own is None else own / 1000.0, 2),
    )
