"""Charts of discoveries: different failures against simulations, and the first failure."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator, PercentFormatter

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.plotting.charts import (
    Look,
    chart_style,
    legend_below,
    looks_of,
    panels,
    write_chart,
)

_TITLE_CHARACTERS = 44
"""Maximum length of a title's line above a panel, characters."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Repetition:
    """One campaign.

    Attributes:
        simulations: Number of its simulations.
        found: Number of simulations up to each different failure, ascending.
    """

    simulations: int
    found: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Discoveries:
    """The discoveries of repeated campaigns on one scenario.

    Attributes:
        title: Title above the panel.
        methods: Repetitions by method.
    """

    title: str
    methods: Mapping[str, Sequence[Repetition]]


def draw_found(
    shown: Sequence[Discoveries], baseline: str, stem: Path, *, of: str = "failures"
) -> tuple[Path, Path]:
    """Draws different failures found against simulations: median and quartiles of repetitions.

    A method's curve ends where its shortest repetition does.

    Args:
        shown: Discoveries, a panel for each; at least one.
        baseline: Name of the method that is drawn in grey.
        stem: Path of the files without suffix.
        of: What was found, in the plural.

    Returns:
        The files, SVG and PNG.
    """
    looks = _looks(shown, baseline)
    with chart_style():
        figure, axes = panels(len(shown))
        for one, panel in zip(shown, axes, strict=True):
            _draw_groups(panel, one, looks, _draw_curve, f"different {of} found")
            panel.yaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
        figure.suptitle(
            "Median of the repetitions; the band holds the middle half",
            fontsize=9,
            x=0.01,
            ha="left",
        )
        legend_below(figure, looks)
        return write_chart(figure, stem)


def draw_first(
    shown: Sequence[Discoveries], baseline: str, stem: Path, *, of: str = "a failure"
) -> tuple[Path, Path]:
    """Draws the share of repetitions that had found a failure against simulations.

    Args:
        shown: Discoveries, a panel for each; at least one.
        baseline: Name of the method that is drawn in grey.
        stem: Path of the files without suffix.
        of: What was found, in the singular.

    Returns:
        The files, SVG and PNG.
    """
    looks = _looks(shown, baseline)
    with chart_style():
        figure, axes = panels(len(shown))
        for one, panel in zip(shown, axes, strict=True):
            _draw_groups(panel, one, looks, _draw_steps, f"repetitions with {of}")
            panel.set_ylim(-0.02, 1.04)
            panel.yaxis.set_major_formatter(PercentFormatter(1.0))
        legend_below(figure, looks)
        return write_chart(figure, stem)


def counts_after(repetitions: Sequence[Repetition]) -> FloatArray:
    """Returns (r, n + 1) different failures that each repetition had after 0 to n simulations.

    n is that of the shortest repetition.
    """
    last = min(one.simulations for one in repetitions)
    at = np.arange(last + 1)
    rows = [np.searchsorted(np.array(one.found), at, side="right") for one in repetitions]
    return np.array(rows, dtype=np.float64)


def _looks(shown: Sequence[Discoveries], baseline: str) -> dict[str, Look]:
    return looks_of([method for one in shown for method in one.methods], baseline)


def _draw_groups(
    axes: Axes,
    one: Discoveries,
    looks: Mapping[str, Look],
    draw: Callable[[Axes, Sequence[Repetition], Look], None],
    label: str,
) -> None:
    for method, look in looks.items():
        if method in one.methods:
            draw(axes, one.methods[method], look)
    axes.set_title(textwrap.fill(one.title, _TITLE_CHARACTERS))
    axes.set_xlabel("simulations")
    axes.set_ylabel(label)
    axes.set_ylim(bottom=0.0)
    axes.margins(x=0.01)
    axes.grid(visible=True)
    axes.xaxis.set_major_locator(MaxNLocator(nbins=6, integer=True))


def _draw_curve(axes: Axes, repetitions: Sequence[Repetition], look: Look) -> None:
    counts = counts_after(repetitions)
    at = np.arange(counts.shape[1])
    low, middle, high = np.quantile(counts, (0.25, 0.5, 0.75), axis=0)
    axes.fill_between(at, low, high, step="post", color=look.color, alpha=0.14, lw=0.0)
    axes.step(at, middle, where="post", color=look.color, ls=look.line, lw=2.0)


def _draw_steps(axes: Axes, repetitions: Sequence[Repetition], look: Look) -> None:
    counts = counts_after(repetitions)
    share = (counts > 0).mean(axis=0)
    at = np.arange(counts.shape[1])
    axes.step(at, share, where="post", color=look.color, ls=look.line, lw=2.0)
