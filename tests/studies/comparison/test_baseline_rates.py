"""Notes on baselines that fail too rarely or too often for a comparison."""

from __future__ import annotations

from dataclasses import replace

from drivora_service.studies.campaign_figures import CampaignFigures
from drivora_service.studies.comparison.baseline_rates import baseline_notes
from tests.studies.comparison.test_campaign_measures import study


def notes(figures: list[CampaignFigures], baseline: str = "random") -> list[str]:
    return list(baseline_notes(figures, baseline, lambda one: one.scenario))


def with_failing(figures: list[CampaignFigures], **failing: int) -> list[CampaignFigures]:
    """Returns figures of campaigns of 100 simulations in which so many of a method fail."""
    return [replace(one, failing=failing.get(one.method, one.failing)) for one in figures]


def test_a_baseline_that_fails_now_and_then_needs_no_note() -> None:
    assert notes(study(3)) == []


def test_a_baseline_that_never_fails_is_noted_with_its_numbers() -> None:
    (note,) = notes(with_failing(study(3), random=0))
    assert note.startswith("s: random fails in 0 of 2000 simulations (0 %; 95 % interval 0 % to")
    assert "under 0.5 %" in note
    assert "`drivora seeds rate`" in note


def test_a_baseline_that_mostly_fails_is_noted() -> None:
    (note,) = notes(with_failing(study(3), random=62))
    assert "1240 of 2000 simulations (62 %" in note
    assert "over 50 %" in note


def test_only_the_baseline_counts_and_each_place_by_itself() -> None:
    figures = study(3, ("s", "t"))
    never = [
        replace(one, failing=0) if (one.scenario, one.method) == ("t", "random") else one
        for one in figures
    ]
    assert [note[0] for note in notes(never)] == ["t"]
    assert notes(with_failing(figures, avfuzzer=0)) == []
    assert len(notes(with_failing(figures, avfuzzer=0), "avfuzzer")) == 2
    assert notes([one for one in never if one.method == "random"]) == []
