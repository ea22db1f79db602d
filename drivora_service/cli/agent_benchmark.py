"""``drivora agents benchmark``: the runs, and what is drawn of them."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.entry import AgentEntry
from drivora_service.benchmarking.card import AgentCard, BenchmarkRun, card_of
from drivora_service.benchmarking.courses import BenchmarkScenario, benchmark_scenarios
from drivora_service.cli.drawing import draw_trace
from drivora_service.cli.installation import network_catalogue
from drivora_service.cli.output import number, print_table
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.running import run_all
from drivora_service.runs.report import RunSpec
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.validation import validate_document
from drivora_service.settings import Settings
from drivora_service.worker_settings import run_limits, worker_setup

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


def entrants(settings: Settings, names: Sequence[str]) -> Entrants:
    """Looks agents up, each once; without names, all that there are.

    Raises:
        UnknownName: There is no agent of a name.
    """
    catalogue = AgentCatalogue(folder=settings.agents_folder)
    entries = [catalogue.entry(name) for name in dict.fromkeys(names or catalogue.names())]
    return Entrants(
        present=tuple(entry for entry in entries if entry.installed),
        absent=tuple(entry for entry in entries if not entry.installed),
    )


def benchmark(
    settings: Settings,
    agents: Sequence[AgentEntry],
    *,
    runs: int,
    out: Path | None,
    on_run: Callable[[AgentEntry], None],
) -> tuple[tuple[AgentCard, ...], dict[str, Path]]:
    """Lets agents drive the benchmark on worker processes of this machine.

    Args:
        settings: With the number of workers.
        agents: Can be used.
        runs: Scenarios of each network.
        out: Where to draw a run of each agent; exists. ``None``: nothing is drawn.
        on_run: Told of whom a run is over.

    Returns:
        Their cards in the order of the agents, and the pictures by agent.

    Raises:
        NetworkError: A network does not offer that many routes.
    """
    if not agents:
        return (), {}
    course = tuple(_ready(benchmark_scenarios(network_catalogue(settings), runs), settings))
    entered = {
        f"{agent.name}-{scenario.name}": (agent, scenario, document)
        for agent in agents
        for scenario, document in course
    }
    done: dict[str, list[BenchmarkRun]] = {agent.name: [] for agent in agents}
    with tempfile.TemporaryDirectory(prefix="drivora-") as scratch:
        specs = (
            RunSpec(
                run_id=name,
                document=document,
                agent=agent.name,
                trace_path="" if out is None else str(_trace(Path(scratch), name)),
            )
            for name, (agent, _, document) in entered.items()
        )
        with LocalExecutor(
            slots=min(settings.workers, len(entered)),
            setup=worker_setup(settings),
            folder=Path(scratch),
            limits=run_limits(settings),
        ) as executor:
            for report in run_all(executor, specs):
                agent, scenario, _ = entered[report.run_id]
                done[agent.name].append(
                    BenchmarkRun(network=scenario.network, number=scenario.number, report=report)
                )
                on_run(agent)
        cards = tuple(card_of(agent, done[agent.name]) for agent in agents)
        pictures = {} if out is None else dict(_pictures(cards, Path(scratch), out, settings))
    return cards, pictures


def print_cards(cards: Sequence[AgentCard], absent: Sequence[AgentEntry]) -> None:
    """Prints a row an agent, and below it why runs were not judged and who could not drive."""
    if cards:
        print_table("", _COLUMNS, map(_row, cards))
    if any(card.agent.privileged for card in cards):
        print("* sees everything, not only what the perception model lets through")
    for card in cards:
        for failure in card.failures:
            print(
                f"{card.agent.name}: {failure.cause or failure.status} in {failure.runs} run(s), "
                f"{failure.example_run}: {failure.example}"
            )
    for agent in absent:
        print(f"{agent.name} was not run: {agent.reason}")


_COLUMNS = (
    "agent",
    "arrived",
    "crashed",
    "at\nfault",
    "avoid-\nable",
    "red\nlights",
    "score",
    "comfort",
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


def _ready(
    wanted: Iterable[BenchmarkScenario], settings: Settings
) -> Iterator[tuple[BenchmarkScenario, str]]:
    """Returns each scenario with the document that workers read."""
    networks = network_catalogue(settings)
    for scenario in wanted:
        valid = validate_document(scenario.document, networks, None)
        yield scenario, canonical_json(valid.scenario)


def _pictures(
    cards: Iterable[AgentCard], scratch: Path, out: Path, settings: Settings
) -> Iterator[tuple[str, Path]]:
    for card in cards:
        if card.shown is not None:
            name = card.agent.name
            picture = out / f"{name}.png"
            trace = _trace(scratch, f"{name}-{card.shown.name}")
            draw_trace(trace, settings, picture, moments=_MOMENTS)
            yield name, picture


def _trace(folder: Path, run_id: str) -> Path:
    return folder / f"{run_id}.trace.parquet"
