from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.method_tables import (
    OWN_TARGETS,
    against_one,
    against_twins,
    brief,
    main,
    read,
)
from benchmarks.methods import METHODS
from drivora_service.studies.comparison.campaign_measures import compare_campaigns, measure
from drivora_service.studies.comparison.study_comparison import (
    By,
    OverviewRow,
    StudyComparison,
    StudyFigures,
)
from drivora_service.studies.comparison.study_comparison_files import write_study_comparison


def figures(method: str, avoidable: int, *, seed: int, laws: float | None = None) -> StudyFigures:
    return StudyFigures(
        agent="idm",
        campaign=f"{method}-{seed}",
        method=method,
        scenario="a street, wet",
        seed=seed,
        simulations=100,
        invalid_share=0.0,
        failed_share=0.0,
        failing=avoidable + 1,
        at_fault=avoidable,
        avoidable=avoidable,
        not_measurable=0,
        unavoidable=0,
        undetermined=1,
        not_judged=0,
        preventable=0,
        not_at_fault=0,
        kinds=1,
        avoidable_kinds=min(avoidable, 1),
        oracles=1,
        groups=None,
        situations=avoidable,
        avoidable_situations=avoidable,
        first_failure=1,
        first_avoidable=7 if avoidable else None,
        found=(1,),
        found_avoidable=(7,) if avoidable else (),
        gene_coverage=0.25,
        simulation_s=10.0,
        own_s=1.0,
        law_coverage=laws,
        budget=100,
    )


FIGURES = tuple(
    figures(method, least + seed, seed=seed, laws=0.5 if method == "random" else 0.75)
    for method, least in (
        ("random", 0),
        ("avfuzzer", 20),
        ("avfuzzer without feedback", 10),
        ("lawbreaker", 0),
    )
    for seed in range(8)
)


@pytest.fixture
def written(tmp_path: Path) -> Path:
    by_method = compare_campaigns(FIGURES, "random", [measure("avoidable")])
    overview = OverviewRow(
        by=By.METHOD,
        measure="avoidable",
        title="avoidable",
        larger_is_better=True,
        name="avfuzzer",
        baseline="random",
        median=1.0,
        baseline_median=1.0,
        a12=1.0,
        places=1,
        better=1,
        worse=0,
        undecided=0,
    )
    comparison = StudyComparison(
        study_id="0",
        name="a study",
        baseline_method="random",
        baseline_agent="idm",
        time_limits_s={},
        notes=(),
        overview=(overview,),
        by_method=by_method,
        by_agent=(),
        campaigns=FIGURES,
    )
    write_study_comparison(comparison, tmp_path)
    return tmp_path / "figures.csv"


def test_figures_are_read_as_a_comparison_writes_them(written: Path) -> None:
    assert tuple(read(written)) == FIGURES


def test_every_method_has_a_target_of_its_own() -> None:
    assert set(OWN_TARGETS) == set(METHODS) - {"random"}


def test_methods_are_compared_by_their_own_targets() -> None:
    rows = {row.method: row for row in against_one(FIGURES)}
    assert {name: row.measure for name, row in rows.items()} == {
        "avfuzzer": "avoidable",
        "lawbreaker": "law_coverage",
    }
    assert rows["avfuzzer"].scenario == "a street, wet, idm"
    assert rows["avfuzzer"].a12 == rows["lawbreaker"].a12 == 1.0
    # Alone by its measure: nothing to correct.
    assert rows["avfuzzer"].p_holm == rows["avfuzzer"].p < 0.05


def test_one_measure_can_be_that_of_all() -> None:
    rows = {row.method: row for row in against_one(FIGURES, "avoidable")}
    assert set(rows) == {"avfuzzer", "avfuzzer without feedback", "lawbreaker"}
    assert rows["lawbreaker"].a12 == 0.5
    assert rows["avfuzzer"].p_holm == pytest.approx(3 * rows["avfuzzer"].p)


def test_a_brief_table_has_a_row_for_each_method_and_a_column_for_each_place() -> None:
    elsewhere = tuple(
        replace(one, scenario="a lane", avoidable=30 - one.avoidable) for one in FIGURES[:16]
    )
    head, *rows = brief(against_one((*FIGURES, *elsewhere), "avoidable"))
    assert head == ("method", "by", "a street, wet, idm", "a lane, idm")
    cells = {row[0]: row[2:] for row in rows}
    assert cells["avfuzzer"] == ("23.5 : 3.5, 1.00 *", "6.5 : 26.5, 0.00 -")
    # No campaigns there.
    assert cells["lawbreaker"] == ("3.5 : 3.5, 0.50", "")


def test_methods_are_compared_with_any_of_them() -> None:
    rows = {row.method: row for row in against_one(FIGURES, "avoidable", "avfuzzer")}
    assert set(rows) == {"random", "avfuzzer without feedback", "lawbreaker"}
    assert rows["random"].a12 == 0.0


def test_methods_are_compared_with_their_twins() -> None:
    (row,) = against_twins(FIGURES)
    assert (row.method, row.baseline) == ("avfuzzer", "avfuzzer without feedback")
    assert (row.median, row.baseline_median, row.a12) == (23.5, 13.5, 1.0)


def test_the_table_marks_large_effects(written: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main([str(written), "--measure", "avoidable"])
    head, _, *rows = capsys.readouterr().out.splitlines()
    assert head.startswith("| method | by | place | n |")
    marks = {row.split(" | ")[0].strip("| "): row.endswith("* |") for row in rows}
    assert marks == {"avfuzzer": True, "avfuzzer without feedback": True, "lawbreaker": False}


def test_parts_of_a_study_are_read_as_one(
    written: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    head, *lines = written.read_text().splitlines()
    parts = [tmp_path / "first.csv", tmp_path / "second.csv"]
    for place, part in enumerate(parts):
        part.write_text("\n".join([head, *lines[place::2], ""]))
    main([str(written)])
    whole = capsys.readouterr().out
    main([str(part) for part in parts])
    assert capsys.readouterr().out == whole


def test_curves_show_all_methods_but_the_twins(
    written: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main([str(written), "--survival", str(tmp_path / "pictures")])
    drawn = [Path(line) for line in capsys.readouterr().out.splitlines()]
    assert [path.name for path in drawn] == ["survival.csv", "survival-1.svg", "survival-1.png"]
    with drawn[0].open(newline="") as file:
        rows = [(r["method"], r["events"], r["median"]) for r in csv.DictReader(file)]
    # Random and LawBreaker found nothing with their first seed.
    assert rows == [("random", "7", "7"), ("avfuzzer", "8", "7"), ("lawbreaker", "7", "7")]
    picture = drawn[1].read_text()
    assert "lawbreaker" in picture
    assert "without feedback" not in picture
