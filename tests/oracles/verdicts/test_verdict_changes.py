from __future__ import annotations

from typing import Any

from drivora_service.oracles.verdicts.verdict_changes import verdict_changes


def test_verdicts_are_compared_by_oracle_and_ego_in_words() -> None:
    before: list[dict[str, Any]] = [
        {"oracle": "collision", "ego": "one", "outcome": "violated", "at_fault": True},
        {"oracle": "collision", "ego": "two", "outcome": "passed"},
        {"oracle": "speeding", "ego": "one", "outcome": "violated"},
        {"oracle": "gone", "ego": "one", "outcome": "not_measurable"},
        {"oracle": "red_light", "ego": "one", "outcome": "passed"},
    ]
    after: list[dict[str, Any]] = [
        {"oracle": "collision", "ego": "one", "outcome": "violated", "at_fault": False},
        {"oracle": "collision", "ego": "two", "outcome": "passed", "message": "elsewhere"},
        {"oracle": "speeding", "ego": "one", "outcome": "violated"},
        {"oracle": "speeding", "ego": "one", "outcome": "violated"},
        {"oracle": "new", "ego": "two", "outcome": "passed"},
        {"oracle": "red_light", "ego": "one", "outcome": "not_applicable"},
    ]
    changes = verdict_changes(before, after)
    assert [(one.oracle, one.ego, one.before, one.after) for one in changes] == [
        ("collision", "one", "violated (at fault)", "violated (not at fault)"),
        ("speeding", "one", "violated", "2 times violated"),
        ("new", "two", "not judged", "passed"),
        ("red_light", "one", "passed", "nothing to judge"),
        ("gone", "one", "not measurable", "not judged"),
    ]
    assert verdict_changes(after, after) == ()
