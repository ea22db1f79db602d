"""Charts of comparisons: the same bytes for the same values, and nothing cut off."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.image import imread

from drivora_service.plotting import colors
from drivora_service.plotting.charts import looks_of
from drivora_service.plotting.discoveries import (
    Discoveries,
    Repetition,
    counts_after,
    draw_first,
    draw_found,
)
from drivora_service.plotting.effects import EffectRow, Values, draw_effects, draw_values

LONG = "samota without feedback (population 12, mutation gaussian)"
METHODS = {"random": 3, "avfuzzer": 6, LONG: 9}


def discoveries(count: int) -> list[Discoveries]:
    random = np.random.default_rng(0)
    return [
        Discoveries(
            title=f"scenario {number}",
            methods={
                method: [
                    Repetition(
                        simulations=60,
                        found=tuple(sorted(random.integers(1, 60, random.poisson(mean)).tolist())),
                    )
                    for _ in range(5)
                ]
                for method, mean in METHODS.items()
            },
        )
        for number in range(count)
    ]


def effects(count: int) -> list[EffectRow]:
    return [
        EffectRow(
            section=f"a measure with quite a long name, scenario {number}",
            method=method,
            a12=a12,
            low=max(0.0, a12 - 0.2),
            high=min(1.0, a12 + 0.2),
            is_significant=a12 > 0.9,
        )
        for number in range(count)
        for method, a12 in (("avfuzzer", 1.0), (LONG, 0.0))
    ]


def values(count: int) -> list[Values]:
    return [
        Values(measure=measure, scenario=f"scenario {number}", methods=methods)
        for measure, methods in (
            ("failures", {"random": [0.0, 0.0], "avfuzzer": [0.0, 0.0], LONG: [0.0, 0.0]}),
            ("share", {"random": [0.1, 0.4], LONG: [0.2, 1.0, 0.3]}),
        )
        for number in range(count)
    ]


CHARTS: dict[str, Callable[[int, Path], tuple[Path, Path]]] = {
    "found": lambda count, stem: draw_found(discoveries(count), "random", stem),
    "first": lambda count, stem: draw_first(discoveries(count), "random", stem),
    "effects": lambda count, stem: draw_effects(effects(count), "random", stem),
    "values": lambda count, stem: draw_values(values(count), "random", stem),
}


@pytest.mark.parametrize("chart", CHARTS)
@pytest.mark.parametrize("count", [1, 4])
def test_nothing_touches_the_edges(chart: str, count: int, tmp_path: Path) -> None:
    svg, png = CHARTS[chart](count, tmp_path / chart)
    assert ElementTree.parse(svg).getroot().tag.endswith("svg")
    pixels = imread(png)[..., :3]
    edges = [pixels[:2], pixels[-2:], pixels[:, :2], pixels[:, -2:]]
    assert all((edge == 1.0).all() for edge in edges)
    assert (pixels < 0.5).any()


@pytest.mark.parametrize("chart", CHARTS)
def test_the_same_values_give_the_same_bytes(chart: str, tmp_path: Path) -> None:
    one, other = (CHARTS[chart](1, tmp_path / name) for name in ("one", "other"))
    assert [path.read_bytes() for path in one] == [path.read_bytes() for path in other]


def test_the_baseline_is_grey_and_first_and_the_others_differ() -> None:
    looks = looks_of(["a", "b", "random", "a", "c"], "random")
    assert list(looks) == ["random", "a", "b", "c"]
    assert looks["random"].color == colors.FAINT_INK
    assert len({(look.color, look.line, look.marker) for look in looks.values()}) == 4
    # In print without colours they still differ.
    assert len({(str(look.line), look.marker) for look in looks.values()}) == 4


def test_counts_go_as_far_as_the_shortest_repetition() -> None:
    counts = counts_after(
        [Repetition(simulations=4, found=(1, 3, 3)), Repetition(simulations=6, found=(5,))]
    )
    assert counts.tolist() == [[0, 1, 1, 3, 3], [0, 0, 0, 0, 0]]
