"""Cards as plain data and as files."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from drivora_service.agents.entry import AgentEntry
from drivora_service.benchmarking.benchmark_run import BenchmarkRun
from drivora_service.benchmarking.card import AgentCard
from drivora_service.benchmarking.card_courses import COURSES, VERSION
from drivora_service.benchmarking.card_text import card_markdown, cards_markdown


def cards_content(
    cards: Sequence[AgentCard], absent: Sequence[AgentEntry], *, runs: int
) -> dict[str, Any]:
    """Returns cards as plain data; the keys are a contract with scripts.

    Args:
        cards: Cards of the agents that drove.
        absent: Agents that could not drive.
        runs: Number of scenarios of each network.
    """
    return {
        "version": VERSION,
        "runs": runs,
        "courses": [asdict(course) for course in COURSES],
        "cards": [_card_content(card) for card in cards],
        "absent": [{"agent": agent.name, "reason": agent.reason} for agent in absent],
    }


def write_cards(
    cards: Sequence[AgentCard],
    absent: Sequence[AgentEntry],
    folder: Path,
    *,
    runs: int,
    pictures: Mapping[str, Path],
) -> tuple[Path, ...]:
    """Writes ``cards.md``, ``cards.json`` and ``NAME.md`` of each agent.

    Args:
        cards: Cards of the agents that drove.
        absent: Agents that could not drive.
        folder: An existing folder.
        runs: Number of scenarios of each network.
        pictures: Pictures of the shown runs in the folder, by agent.

    Returns:
        The written files.
    """
    table, data = folder / "cards.md", folder / "cards.json"
    table.write_text(cards_markdown(cards, absent, runs=runs))
    content = cards_content(cards, absent, runs=runs)
    data.write_text(json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n")
    pages = []
    for card in cards:
        picture = pictures.get(card.agent.name)
        pages.append(folder / f"{card.agent.name}.md")
        pages[-1].write_text(
            card_markdown(card, runs=runs, picture="" if picture is None else picture.name)
        )
    return (table, data, *pages)


def _card_content(card: AgentCard) -> dict[str, Any]:
    return {
        "agent": card.agent.name,
        "kind": card.agent.kind,
        "privileged": card.agent.privileged,
        "total": asdict(card.total),
        "networks": {own.network: asdict(own.figures) for own in card.networks},
        "violated": [asdict(violated) for violated in card.violated],
        "failures": [asdict(failure) for failure in card.failures],
        "shown": None if card.shown is None else card.shown.name,
        "runs": [_run_content(run) for run in card.runs],
    }


def _run_content(run: BenchmarkRun) -> dict[str, Any]:
    error = run.record.error
    return {
        "scenario": run.name,
        "status": run.record.status,
        "cause": None if error is None else error.cause,
        "arrived": run.arrived,
        "violated": sorted({verdict.oracle for verdict in run.violations}),
        "at_fault": sorted({verdict.oracle for verdict in run.violations if verdict.at_fault}),
        "driving_score": run.metric("driving_score"),
        "sim_time_s": run.record.sim_time_s,
        "step_cost_us": run.record.step_cost_us,
        "agent_cost_us": run.agent_cost_us,
        "trace_sha256": run.record.trace_sha256,
    }
