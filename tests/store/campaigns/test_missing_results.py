"""The words for runs without a result."""

from __future__ import annotations

from drivora_service.runs.run_report import RunStatus
from drivora_service.store.campaigns.missing_results import MissingResult, missing_words


def reason(message: str, runs: int) -> MissingResult:
    return MissingResult(
        status=RunStatus.PLUGIN_FAILED, cause="raised", message=message, evaluation=0, runs=runs
    )


def test_one_reason_of_all_runs_is_named_without_a_number() -> None:
    assert missing_words(0, ()) == "0 runs without a result"
    assert missing_words(1, [reason("it raised\ntwice", 1)]) == "1 run without a result: it raised"
    assert missing_words(2, [reason("", 2)]) == "2 runs without a result: raised"


def test_the_most_frequent_of_several_reasons_is_named_with_its_number() -> None:
    found = [reason("it raised", 3), reason("it hung", 1)]
    assert missing_words(4, found) == (
        "4 runs without a result: it raised (3 of 4, the most frequent reason)"
    )
    # The reasons of the first 200 runs are read.
    assert missing_words(500, [reason("it raised", 200)]).endswith(
        "it raised (200 of 200, the most frequent reason)"
    )
