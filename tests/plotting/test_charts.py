"""Charts of comparisons: the same bytes for the same values, and nothing cut off."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.image import imread

from drivora_service.plotting import colors
from drivora_service.plotting.charts import looks_of
from drivora_service.plotting.discovery_chart import (
    Discoveries,
    Repetition,
    counts_after,
    draw_first,
    draw_found,
)
from drivora_service.plotting.effect_chart import EffectRow, Values, draw_effects, draw_values
from drivora_service.plotting.survival_chart import (
    MOST_LINES,
    SurvivalLine,
    SurvivalPanel,
    draw_survival,
    method_groups,
    spread,
)

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


def survivals(count: int) -> list[SurvivalPanel]:
    methods = {
        "random": SurvivalLine(at=(0, 60), share=(1.0, 1.0), median=None),
        LONG: SurvivalLine(at=(0, 9, 20, 60), share=(1.0, 0.6, 0.4, 0.4), median=20),
        # At equal time some end before others.
        "avfuzzer": SurvivalLine(at=(0, 25), share=(1.0, 1.0), median=None),
        "costs $5 to $9": SurvivalLine(at=(0, 1), share=(1.0, 0.0), median=1),
    } | {
        f"method {number}": SurvivalLine(at=(0, 30, 60), share=(1.0, 0.5, 0.5), median=30)
        for number in range(7)
    }
    return [SurvivalPanel(title=f"scenario {number}", methods=methods) for number in range(count)]


CHARTS: dict[str, Callable[[int, Path], tuple[Path, Path]]] = {
    "found": lambda count, stem: draw_found(discoveries(count), "random", stem),
    "first": lambda count, stem: draw_first(discoveries(count), "random", stem),
    "effects": lambda count, stem: draw_effects(effects(count), "random", stem),
    "values": lambda count, stem: draw_values(values(count), "random", stem),
    "survival": lambda count, stem: draw_survival(
        survivals(count), "random", stem, of="a third kind of avoidable at-fault failure"
    ),
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


def test_seventeen_methods_have_looks_of_their_own() -> None:
    looks = looks_of([f"method {number}" for number in range(16)] + ["random"], "random")
    assert len({(look.color, str(look.line)) for look in looks.values()}) == 17
    # Those that share a panel also differ without colours.
    for group in method_groups(list(looks), "random"):
        assert len({(str(looks[one].line), looks[one].marker) for one in group}) == len(group)


@pytest.mark.parametrize("others", [1, 8, 9, 16, 25])
def test_a_panel_has_nine_lines_at_most_and_the_baseline(others: int) -> None:
    methods = ["random", *(f"method {number}" for number in range(others))]
    groups = method_groups(methods, "random")
    assert all(group[0] == "random" and 2 <= len(group) <= MOST_LINES for group in groups)
    assert [name for group in groups for name in group[1:]] == methods[1:]
    assert max(map(len, groups)) - min(map(len, groups)) < len(groups)
    assert method_groups(["random"], "random") == [["random"]]
    assert method_groups(["a", "b"], "random") == [["a", "b"]]


def test_labels_do_not_touch_and_stay_where_there_is_room() -> None:
    wanted, heights = [0.0, 0.0, 0.1, 0.7, 1.0, 1.0], [0.1, 0.1, 0.2, 0.1, 0.1, 0.1]
    centres = spread(wanted, heights, 1.0)
    ends = [(c - h / 2, c + h / 2) for c, h in zip(centres, heights, strict=True)]
    assert all(low >= high - 1e-12 for (_, high), (low, _) in pairwise(ends))
    assert ends[-1][1] <= 1.0
    assert centres[0] == pytest.approx(0.0)
    assert centres[3] == 0.7


def test_a_curve_is_drawn_with_its_method_and_median(tmp_path: Path) -> None:
    svg, _ = draw_survival(survivals(1), "random", tmp_path / "survival", of="it")
    # Text is written as glyphs, and named in a comment.
    text = svg.read_text()
    for label in ("method 6  30", "random  &gt;60", "avfuzzer  &gt;25", "costs $5 to $9  1"):
        assert label in text or label.replace("&gt;", ">") in text
    assert text.count("random  ") == 2, "the baseline is in both panels"
