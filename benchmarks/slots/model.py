"""The limits of throughput, fitted to measured points, and their table and curve."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path

import numpy as np

from benchmarks.slots.service import Point
from drivora_service.plotting import charts, colors

_MANY = 1000
"""Slots of a cluster, far more than can be measured on one machine."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Model:
    """The limits of throughput.

    Attributes:
        run_s: Seconds of a run in its worker.
        gap_s: Seconds of a slot between two runs.
        fixed: Share of one core that their owner uses for what does not depend on runs.
        own_s: Processor seconds of the owner a run.
    """

    run_s: float
    gap_s: float
    fixed: float
    own_s: float

    def rate(self, slots: float) -> float:
        """Returns the runs a second on so many slots, each with a core of its own.

        The owner is one process of Python, which computes on one core at a time.
        """
        return min(slots / (self.run_s + self.gap_s), self.most)

    @property
    def most(self) -> float:
        """Runs a second that the owner can hand out, on any number of slots."""
        return (1.0 - self.fixed) / self.own_s

    def efficiency(self, slots: float) -> float:
        """Returns the share of the slots' time in which they perform runs."""
        return self.rate(slots) * self.run_s / slots

    def shortest_run_s(self, slots: float, efficiency: float) -> float:
        """Returns the seconds that runs must take for so many slots to be so busy."""
        by_owner = efficiency * slots / self.most
        by_gaps = self.gap_s * efficiency / (1.0 - efficiency)
        return max(by_owner, by_gaps)


def fit(
    points: Sequence[Point],
    run_s: float,
    share: Callable[[Point], float] = attrgetter("own_share"),
) -> Model:
    """Fits the model to measured points, with runs of ``run_s`` seconds.

    Simulated workers have no supervision, and count only if there are no others.

    Args:
        points: The points.
        run_s: Seconds.
        share: Returns the share of one core that the process in question used.
    """
    points = [point for point in points if point.kind != "simulated"] or points
    rates = np.array([point.rate for point in points])
    shares = np.array([share(point) for point in points])
    # Relative errors count: the shares differ by two orders of magnitude.
    weights = 1.0 / shares
    columns = np.stack([rates, np.ones_like(rates)], axis=1) * weights[:, None]
    own_s, fixed = np.linalg.lstsq(columns, shares * weights, rcond=None)[0]
    gaps = [p.run_s * (1.0 / p.efficiency - 1.0) for p in points if p.kind == "real"]
    return Model(
        run_s=run_s,
        gap_s=float(np.mean(gaps)) if gaps else 0.0,
        fixed=max(float(fixed), 0.0),
        own_s=float(own_s),
    )


def table(measured: Sequence[Point], model: Model) -> str:
    """Returns the points and the model as a table in Markdown."""
    lines = [
        "| K | workers | runs/s | ms a run in its worker | owner, ms a run | owner, share of a "
        "core | efficiency | of the model |",
        "|---|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {p.slots} | {p.kind} | {p.rate:.1f} | {1e3 * p.run_s:.1f} | {p.own_ms:.3f} "
        f"| {p.own_share:.1%} | {p.efficiency:.1%} | {model.efficiency(p.slots):.1%} |"
        for p in measured
    ]
    slots = model.most * (model.run_s + model.gap_s)
    lines += [
        "",
        f"Model, for runs of {1e3 * model.run_s:.0f} ms: {1e3 * model.own_s:.3f} ms of the "
        f"process that owns the slots (the owner) a run, {model.fixed:.1%} of a core whatever the "
        f"runs, {1e3 * model.gap_s:.1f} ms of a slot between two runs. The owner is full at "
        f"{model.most:.0f} runs a "
        f"second, which are {slots:.0f} slots; 90 % efficiency at {_slots_at(model, 0.9):.0f}.",
        "",
        f"By the model, {_MANY} slots are {model.efficiency(_MANY):.0%} busy with runs of "
        f"{1e3 * model.run_s:.0f} ms, and 90 % busy with runs of "
        f"{1e3 * model.shortest_run_s(_MANY, 0.9):.0f} ms or more.",
    ]
    return "\n".join(lines) + "\n"


def cluster_table(measured: Sequence[Point], model: Model) -> str:
    """Returns the points on a Ray cluster, and what limits it, as a table in Markdown.

    Args:
        measured: The points.
        model: Fitted to the process of the service.
    """
    driver = fit(measured, model.run_s, attrgetter("driver_share"))
    lines = [
        "| K | runs/s | ms a run in its worker | service, ms a run | driver, ms a run | actors of "
        "the nodes, ms a run | other processes of Ray, ms a run | efficiency |",
        "|---|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {p.slots} | {p.rate:.1f} | {1e3 * p.run_s:.1f} | {p.own_ms:.3f} | {p.driver_ms:.3f} "
        f"| {p.nodes_ms:.3f} | {p.ray_ms:.3f} | {p.efficiency:.1%} |"
        for p in measured
    ]
    for name, one in (("service", model), ("process that is connected with Ray", driver)):
        lines += [
            "",
            f"The {name} needs {1e3 * one.own_s:.3f} ms a run and {one.fixed:.1%} of a core "
            f"whatever the runs: it is full at {one.most:.0f} runs a second, and {_MANY} slots are "
            f"90 % busy with runs of {1e3 * one.shortest_run_s(_MANY, 0.9):.0f} ms or more.",
        ]
    return "\n".join(lines) + "\n"


def _slots_at(model: Model, efficiency: float) -> float:
    """Returns the number of slots at which the efficiency has fallen to a value; 0: at one."""
    if model.efficiency(1.0) < efficiency:
        return 0.0
    return model.most * model.run_s / efficiency


def draw(measured: Sequence[Point], model: Model, stem: Path) -> None:
    """Writes the curve as SVG and PNG."""
    with charts.chart_style():
        figure, (rates, shares) = charts.panels(2)
        ends = (1.0, 4.0 * model.most * model.run_s)
        slots = np.geomspace(*ends, 200)
        looks = charts.looks_of(
            ["ideal", "model", *dict.fromkeys(p.kind for p in measured)], "ideal"
        )
        ideal, line = looks["ideal"], looks["model"]
        rates.loglog(slots, slots / model.run_s, color=ideal.color, ls=ideal.line)
        rates.loglog(slots, [model.rate(k) for k in slots], color=line.color)
        shares.semilogx(slots, [model.efficiency(k) for k in slots], color=line.color)
        for point in measured:
            look = looks[point.kind]
            rates.plot(
                point.slots,
                point.slots * point.efficiency / model.run_s,
                look.marker,
                color=look.color,
            )
            shares.plot(point.slots, point.efficiency, look.marker, color=look.color)
        rates.set(title="Throughput", xlabel="slots", ylabel="runs a second")
        shares.set(title="Efficiency", xlabel="slots", ylim=(0.0, 1.05))
        shares.axhline(0.9, color=colors.ROAD_EDGE, lw=0.8)
        for axes in (rates, shares):
            axes.grid(visible=True)
        charts.legend_below(figure, looks)
        charts.write_chart(figure, stem)
