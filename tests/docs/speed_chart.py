"""The chart of the README: simulated time for each second of processor time, from the results."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

_ROOT = Path(__file__).resolve().parents[2]
RESULTS = _ROOT / "benchmarks" / "results" / "benchmarks.json"
CHART = _ROOT / "docs" / "images" / "speed.svg"
_LABELS = {
    "Drivora": "Drivora, a whole run with all oracles",
    "highway-env, 20 Hz": "highway-env, 20 Hz",
    "SUMO over TraCI": "SUMO over TraCI, placing vehicles only",
}
_COLOURS = {"Drivora": "#1f5fa8", "highway-env, 20 Hz": "#9aa5b1", "SUMO over TraCI": "#9aa5b1"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Speed:
    """The median speed of one simulator.

    Attributes:
        simulator: Its name.
        case: Number of vehicles, in words.
        factor: Simulated seconds for each second of processor time.
    """

    simulator: str
    case: str
    factor: float


def read_speeds() -> list[Speed]:
    """Returns the measured speeds, in the order of the results."""
    sections = json.loads(RESULTS.read_text())["sections"]
    (peers,) = (section for section in sections if section["name"] == "peers")
    return [
        Speed(
            simulator=series["quantity"]["name"].removesuffix(", x real time"),
            case=series["quantity"]["case"],
            factor=sorted(series["values"])[len(series["values"]) // 2],
        )
        for series in peers["series"]
        if series["quantity"]["unit"] == "x real time"
        and series["quantity"]["name"].removesuffix(", x real time") in _LABELS
    ]


def draw_speed_chart() -> None:
    """Draws the chart."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    # Without these, ids and the date would differ from drawing to drawing.
    mpl.rcParams["svg.hashsalt"] = "speed"
    speeds = read_speeds()
    figure = Figure(figsize=(8.0, 3.4), layout="constrained")
    axes = figure.subplots()
    rows = [f"{_LABELS[speed.simulator]}\n{speed.case}" for speed in speeds]
    bars = axes.barh(
        rows, [s.factor for s in speeds], color=[_COLOURS[s.simulator] for s in speeds], height=0.6
    )
    axes.bar_label(bars, [f"{speed.factor:,.0f} x" for speed in speeds], padding=4, fontsize=9)
    axes.set_xscale("log")
    axes.set_xlim(1, 12_000)
    axes.invert_yaxis()
    axes.set_xlabel("simulated seconds for each second of processor time (logarithmic)", fontsize=9)
    axes.tick_params(labelsize=8)
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(CHART, metadata={"Date": None})
