"""One sentence that tells how two batches stand."""

from __future__ import annotations

from drivora_service.suites.paired.batch_comparison import FailureComparison, PairedJudgement

_ANSWERS = {
    PairedJudgement.BETTER: "B fails less",
    PairedJudgement.WORSE: "B fails more",
    PairedJudgement.UNDECIDED: "no difference is shown",
}


def describe_outcome(
    failures: FailureComparison, *, a: str = "", b: str = "", has_repetitions: bool = False
) -> str:
    """Returns the sentence.

    Args:
        failures: Scenarios with any failure.
        a: What sets A apart; "": only "A".
        b: What sets B apart.
        has_repetitions: Whether a scenario has several pairs.
    """
    first, second = (f"{name} ({words})" if words else name for name, words in (("A", a), ("B", b)))
    scenarios = failures.scenarios
    if not scenarios:
        return f"Nothing is compared: no run of {first} has a judged counterpart in {second}."
    of = f"{scenarios} scenario{'' if scenarios == 1 else 's'}"
    if not failures.a_only + failures.b_only:
        if not failures.both:
            return f"{first} and {second} do not fail in any of {of}."
        equally = "equally often " if has_repetitions else ""
        return (
            f"{first} and {second} fail {equally}in the same {failures.both} of {of}: no "
            "difference is shown."
        )
    a_only, b_only = failures.a_only or "none", failures.b_only or "none"
    test = failure_test(has_repetitions=has_repetitions)
    rest = f"(p {probability(failures.p)}, {test}): {_ANSWERS[failures.judgement]}."
    if has_repetitions:
        return (
            f"{second} fails more often than {first} in {b_only} of {of}, and A more "
            f"often than B in {a_only} {rest}"
        )
    return (
        f"{second} fails in {b_only} of {of} in which {first} does not, and A in "
        f"{a_only} in which B does not {rest}"
    )


def failure_test(*, has_repetitions: bool) -> str:
    """Returns the name of the test of failures.

    Args:
        has_repetitions: Whether a scenario has several pairs.
    """
    return "exact sign test over scenarios" if has_repetitions else "McNemar's exact test"


def probability(p: float) -> str:
    """Writes a p-value."""
    if p < 0.001:
        return "< 0.001"
    return f"{p:.3f}" if p < 0.1 else f"{p:.2f}"
