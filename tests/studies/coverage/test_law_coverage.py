from __future__ import annotations

from typing import Any

from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.studies.coverage.law_coverage import law_coverage, law_verdicts


def verdict(oracle: str, **evidence: Any) -> Verdict:
    shown = bool(evidence.get("sub_violations"))
    outcome = Outcome.VIOLATED if shown else Outcome.PASSED
    return Verdict(oracle=oracle, ego="ego", outcome=outcome, message="m", evidence=evidence)


def test_without_laws_it_is_not_known() -> None:
    assert law_coverage([]) is None
    assert law_coverage([verdict("collision")]) is None


def test_each_way_counts_once_for_each_law() -> None:
    verdicts = [
        verdict("collision"),
        verdict("speed", ways=3, sub_violations=["a", "b"]),
        verdict("speed", ways=3, sub_violations=["a"]),
        verdict("light", ways=1, sub_violations=["a"]),
        verdict("lane", ways=1),
    ]
    assert law_coverage(verdicts) == 3 / 5


def test_a_way_that_may_have_been_shown_does_not_count() -> None:
    perhaps = verdict("speed", ways=2, sub_violations=[], possible_sub_violations=["a"])
    assert law_coverage([perhaps]) == 0.0


def test_what_is_kept_of_verdicts_gives_the_same_coverage() -> None:
    verdicts = [
        verdict("collision", speed=3.0),
        verdict("speed", ways=3, sub_violations=["a", "b"], curve_times=[0.0] * 60),
        verdict("lane", ways=1),
        verdict("lane", ways=1),
    ]
    kept = law_verdicts(verdicts)
    assert [one.oracle for one in kept] == ["speed", "lane"]
    assert law_coverage(kept) == law_coverage(verdicts) == 2 / 4
    assert law_verdicts(verdicts)[1] is kept[1]
    assert set(kept[0].evidence) == {"ways", "sub_violations"}
