"""The chart of the README shows what was measured."""

from __future__ import annotations

from pathlib import Path

from tests.docs.speed_chart import CHART, draw_speed_chart, read_speeds

_README = (Path(__file__).resolve().parents[2] / "README.md").read_text()


def test_the_readme_says_the_measured_speeds() -> None:
    (text,) = (line for line in _README.splitlines() if line.endswith("docs/images/speed.svg)"))
    speeds = read_speeds()
    assert len(speeds) == 6
    for speed in speeds:
        assert f"{speed.factor:,.0f}" in text, speed


def test_the_chart_is_drawn_from_the_results() -> None:
    committed = CHART.read_text()
    try:
        draw_speed_chart()
        drawn = CHART.read_text()
    finally:
        CHART.write_text(committed)
    # Fonts differ from machine to machine, the bars do not.
    assert _bars(drawn) == _bars(committed)


def _bars(svg: str) -> list[str]:
    return [line.strip() for line in svg.splitlines() if "fill: #" in line]
