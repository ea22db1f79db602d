"""Cards as Markdown: a table of all agents, and a page for each."""

from __future__ import annotations

from collections.abc import Sequence

from drivora_service.agents.entry import AgentEntry
from drivora_service.benchmarking.benchmark_run import BenchmarkRun
from drivora_service.benchmarking.card import AgentCard, Figures
from drivora_service.benchmarking.card_courses import COURSES, VERSION
from drivora_service.markdown_text import Markdown, code_span, escape_markdown, escape_prose, table

COLUMNS = (
    "runs",
    "arrived",
    "crashed",
    "at fault",
    "avoidable",
    "preventable",
    "red lights",
    "driving score",
    "comfort",
    "step (ms)",
    "95 %",
    "agent (ms)",
    "failed",
)
"""Columns of :func:`cells`, in this order."""


def cells(figures: Figures) -> tuple[str, ...]:
    """Writes figures as cells of a table; not measurable ones are a dash."""
    judged = figures.judged
    return (
        str(figures.runs),
        str(figures.arrivals),
        *(
            str(count) if judged else "-"
            for count in (
                figures.collisions,
                figures.at_fault_collisions,
                figures.avoidable_collisions,
                figures.preventable_collisions,
                figures.red_lights,
            )
        ),
        _number(figures.driving_score, 1),
        _number(figures.comfort, 2),
        _milliseconds(figures.step_cost_median_us),
        _milliseconds(figures.step_cost_p95_us),
        _milliseconds(figures.agent_cost_median_us),
        str(figures.runs - judged),
    )


def view_of(agent: AgentEntry) -> str:
    """Returns the view of an agent."""
    return "privileged" if agent.privileged else "perception"


def describe_conditions(runs: int) -> tuple[str, ...]:
    """Returns the conditions of the cards.

    Args:
        runs: Number of scenarios of each network.
    """
    return (
        f"Benchmark version {VERSION}: {runs} generated scenarios on each network, one ego, "
        "background traffic.",
        *(
            f"{course.network}: routes of {course.min_length:g} to {course.max_length:g} m, "
            f"{course.background} vehicles, seeds from {course.seed}."
            for course in COURSES
        ),
    )


HOW_TO_READ = (
    "Counts are of runs. *arrived*: in time; *crashed*: touched another actor, *at fault*: by its "
    "own fault, *avoidable*: where a careful and competent driver avoids it; *preventable*: by the "
    "fault of others, where such a driver avoids it; *red lights*: ran at least one. *driving "
    "score*: mean of Leaderboard 2.1 (per cent), 0 where the agent failed. *comfort*: mean share "
    "of the time within nuPlan's bounds. *step*, *95 %*: median and 95th percentile over the runs "
    "of the mean wall time of a step, simulation and agent together; *agent*: the median of the "
    "agent's share of it, a dash where SUMO drives. *failed*: runs without a judgement. *view*: "
    "whether the agent sees everything, or what the perception model lets through."
)


def cards_markdown(cards: Sequence[AgentCard], absent: Sequence[AgentEntry], *, runs: int) -> str:
    """Writes the table over all agents.

    Args:
        cards: Cards of agents that drove, each with a page ``NAME.md`` beside the text.
        absent: Agents that could not drive.
        runs: Number of scenarios of each network.
    """
    lines = ["# Agent cards", ""]
    lines += [f"- {line}" for line in describe_conditions(runs)]
    lines += ["", HOW_TO_READ, ""]
    rows = ((_link(card.agent), view_of(card.agent), *cells(card.total)) for card in cards)
    lines += table(("agent", "view", *COLUMNS), rows)
    if absent:
        lines += ["", "Not run:", ""]
        lines += [f"- {code_span(agent.name)}: {escape_prose(agent.reason)}" for agent in absent]
    return "\n".join(lines) + "\n"


def _link(agent: AgentEntry) -> Markdown:
    return Markdown(f"[`{agent.name}`]({agent.name}.md)")


def card_markdown(card: AgentCard, *, runs: int, picture: str = "") -> str:
    """Writes the page of one agent.

    Args:
        card: The card.
        runs: Number of scenarios of each network.
        picture: Address of the shown run's picture, relative to the text.
    """
    agent = card.agent
    lines = [f"# {escape_markdown(agent.name)}", "", f"{escape_markdown(agent.description)}.", ""]
    lines += [
        f"- Kind: {agent.kind}",
        f"- From: {escape_markdown(agent.source)}",
        f"- Licence: {escape_markdown(agent.licence or 'none stated')}",
        f"- View: {view_of(agent)}",
        f"- Arrived in time without a collision at its fault: {card.total.clean_arrivals} of "
        f"{card.total.runs} runs",
        f"- Within the bounds of comfort all the time: {card.total.comfortable} of "
        f"{card.total.judged} judged runs",
        *_scores(card.total),
    ]
    lines += [f"- {line}" for line in describe_conditions(runs)]
    lines += ["", HOW_TO_READ, ""]
    rows = [(own.network, *cells(own.figures)) for own in card.networks]
    lines += table(("network", *COLUMNS), (*rows, ("all", *cells(card.total))))
    lines += ["", "## Violations", ""]
    lines += _wrongs(card)
    if picture and card.shown is not None:
        lines += ["", "## A run", "", escape_markdown(_about(card.shown)), ""]
        lines += [f"![{escape_markdown(f'{agent.name} on {card.shown.name}')}]({picture})"]
    return "\n".join(lines) + "\n"


def _scores(figures: Figures) -> list[str]:
    """Returns the scores of benchmarks; not measurable ones are a dash."""
    deviation = _number(figures.driving_score_deviation, 1)
    return [
        f"- CARLA Leaderboard: driving score {_number(figures.driving_score, 1)} with a standard "
        f"deviation of {deviation} (2.1), {_number(figures.driving_score_2_0, 1)} (2.0), "
        f"{_number(figures.driving_score_1_0, 1)} (1.0); route completion "
        f"{_number(figures.route_completion, 1)}",
        f"- Bench2Drive: success rate {_number(figures.success_rate, 2)}, efficiency "
        f"{_number(figures.efficiency, 1)}, comfort {_number(figures.comfort, 2)}",
        f"- nuPlan: closed-loop score {_number(figures.nuplan_closed_loop, 2)}, with a computed "
        "free drive in place of an expert's log",
    ]


def _wrongs(card: AgentCard) -> list[str]:
    lines = []
    if card.violated:
        lines += table(
            ("oracle", "runs", "at fault", "for example"),
            (
                (
                    violated.oracle.replace("_", " "),
                    str(violated.runs),
                    str(violated.at_fault) if violated.at_fault else "",
                    f"{violated.example_run}: {violated.example}",
                )
                for violated in card.violated
            ),
        )
    elif card.total.judged:
        lines.append("It violated no oracle in any judged run.")
    if card.failures:
        lines += [""] if lines else []
        lines += table(
            ("runs without a judgement", "cause", "runs", "for example"),
            (
                (
                    failure.status.replace("_", " "),
                    failure.cause,
                    str(failure.runs),
                    f"{failure.example_run}: {failure.example}",
                )
                for failure in card.failures
            ),
        )
    return lines


def _about(run: BenchmarkRun) -> str:
    if not run.violations:
        return f"The longest run, {run.name}; no oracle was violated in it."
    # Only the first of each oracle: some are violated at every bend.
    said: dict[str, str] = {}
    for verdict in run.violations:
        said.setdefault(verdict.oracle, verdict.message)
    return f"The run with the most violations, {run.name}: {' '.join(said.values())}"


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def _milliseconds(microseconds: float | None) -> str:
    return "-" if microseconds is None else f"{microseconds / 1000:.2f}"
