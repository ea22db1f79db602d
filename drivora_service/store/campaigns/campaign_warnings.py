"""Warnings that a campaign in which everything or nothing fails says little about the ADS."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.accountability import IN_WORDS, accountability
from drivora_service.shapes import Shape
from drivora_service.store.campaigns.seed_run_records import SeedRun

if TYPE_CHECKING:
    from drivora_service.store.campaigns.campaign_records import CampaignCounts

PAGE = "docs/how-to/when-everything-or-nothing-fails.md"
"""The page of the documentation that says what to do."""

NEARLY_ALL = 0.9
"""Share of the simulations from which on all of them are said to fail."""
LEAST_JUDGED = 10
"""Judged simulations before it is said that all of them fail."""
LEAST_WITHOUT_RESULT = 3
"""Simulations before it is said that none of them has a result."""
MANY = 100
"""Judged simulations without a failure after which a campaign that is not over is warned about."""
CONFIDENCE = 0.95
_SHOWN_SEEDS = 3
_SHOWN_FAILURES = 3


class WarningCode(StrEnum):
    """What a warning is about."""

    ADS_FAILS = "ads_fails"
    """The ADS itself fails in nearly all simulations."""
    NO_RESULTS = "no_results"
    """Nearly all simulations have no result, mostly for other reasons."""
    SEED_FAILS = "seed_fails"
    """A seed scenario fails as it is."""
    ALL_FAIL = "all_fail"
    """Nearly all simulations fail."""
    NONE_FAILS = "none_fails"
    """No simulation fails."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CampaignWarning(Shape):
    """A warning that a campaign says little, as far as it is.

    Attributes:
        code: What it is about.
        message: What was found.
        advice: What to do first.
        page: Page of the documentation with causes and commands, and the section.
    """

    code: WarningCode
    message: str
    advice: str
    page: str


def campaign_warnings(
    counts: CampaignCounts, seed_runs: Sequence[SeedRun], *, is_finished: bool
) -> tuple[CampaignWarning, ...]:
    """Returns the warnings about a campaign, the gravest first.

    Args:
        counts: Its counts so far.
        seed_runs: The runs of its seed scenarios so far.
        is_finished: Whether its budget is spent.
    """
    return tuple(_warnings(counts, seed_runs, is_finished=is_finished))


def upper_bound(simulations: int) -> float:
    """Returns the rate below which failures are, with 95 % confidence, if none was found.

    The exact one-sided bound of Clopper and Pearson for no event, 1 - 0.05^(1/n); for 30 and more
    simulations nearly the rule of three, 3/n (Hanley and Lippman-Hand, JAMA 249, 1983).

    Args:
        simulations: Independent simulations, at least one.
    """
    return 1.0 - float((1.0 - CONFIDENCE) ** (1.0 / simulations))


def _warnings(
    counts: CampaignCounts, seed_runs: Sequence[SeedRun], *, is_finished: bool
) -> Iterator[CampaignWarning]:
    made, judged = counts.simulations, counts.judged
    if made >= LEAST_WITHOUT_RESULT and counts.failed >= NEARLY_ALL * made:
        yield _without_result(counts)
    failing = [one for one in seed_runs if one.failures or one.ads_failed]
    if failing:
        yield _failing_seeds(failing, len(seed_runs))
    if judged >= LEAST_JUDGED and counts.violating >= NEARLY_ALL * judged:
        yield _all_fail(counts, seed_runs)
    is_enough = judged > 0 if is_finished else judged >= MANY
    if is_enough and counts.violating == 0 and not counts.agent_failed:
        yield _none_fails(judged, counts)


def _without_result(counts: CampaignCounts) -> CampaignWarning:
    made, own = counts.simulations, counts.agent_failed
    if own is not None and own >= NEARLY_ALL * made:
        return CampaignWarning(
            code=WarningCode.ADS_FAILS,
            message=f"The ADS itself failed in {own} of {made} simulations: it raised, hung, died "
            "or answered invalidly.",
            advice="Run the seed scenario alone with `drivora run`, which prints why, and mend "
            "the ADS first.",
            page=f"{PAGE}#the-ads-itself-fails",
        )
    return CampaignWarning(
        code=WarningCode.NO_RESULTS,
        message=f"{counts.failed} of {made} simulations have no result.",
        advice="The evaluations say why: `drivora campaign show ID --evaluation 0`.",
        page=f"{PAGE}#runs-have-no-result",
    )


def _failing_seeds(failing: Sequence[SeedRun], tried: int) -> CampaignWarning:
    shown = "; ".join(_seed_words(one) for one in failing[:_SHOWN_SEEDS])
    more = len(failing) - _SHOWN_SEEDS
    listed = f"{shown}; and {more} more" if more > 0 else shown
    if tried == 1 and not failing[0].name:
        message = f"The seed scenario itself fails: {listed}."
    else:
        message = f"{len(failing)} of {tried} seed scenarios fail as they are: {listed}."
    return CampaignWarning(
        code=WarningCode.SEED_FAILS,
        message=message,
        advice="Drive it alone with `drivora run` and mend what fails, or begin with a scenario "
        "that the ADS drives: else the failures are not those of what the search adds.",
        page=f"{PAGE}#the-seed-scenario-itself-fails",
    )


def _seed_words(one: SeedRun) -> str:
    name = f"{one.name!r} " if one.name else ""
    if one.error is not None and one.ads_failed:
        return f"{name}the ADS itself failed ({one.error.cause}: {one.error.message})"
    firsts: dict[str, Verdict] = {}
    for verdict in one.failures:
        firsts.setdefault(verdict.oracle, verdict)
    found = [_failure_words(verdict) for verdict in list(firsts.values())[:_SHOWN_FAILURES]]
    more = len(firsts) - _SHOWN_FAILURES
    return name + ", ".join(found) + (f" and {more} more" if more > 0 else "")


def _failure_words(verdict: Verdict) -> str:
    fault = IN_WORDS[accountability(verdict)]
    when = "" if verdict.time is None else f" at {verdict.time:.1f} s"
    return f"{verdict.oracle}{when}" + (f" ({fault})" if fault else "")


def _all_fail(counts: CampaignCounts, seed_runs: Sequence[SeedRun]) -> CampaignWarning:
    passed = [one for one in seed_runs if not one.failures and not one.ads_failed]
    if seed_runs and len(passed) == len(seed_runs):
        seed = "the seed passes" if len(seed_runs) == 1 else "the seeds pass"
        cause = f"; {seed}, so that what the search adds or the definition of a failure decides"
    else:
        cause = ""
    return CampaignWarning(
        code=WarningCode.ALL_FAIL,
        message=f"{counts.violating} of {counts.judged} simulations fail{cause}.",
        advice="A search that always succeeds finds nothing special: look at the kinds of "
        "failures, and name the `oracles` and `counts` that matter.",
        page=f"{PAGE}#everything-fails",
    )


def _none_fails(judged: int, counts: CampaignCounts) -> CampaignWarning:
    apart = ", ".join(f"{number} {words}" for number, words in counts.apart)
    if apart:
        found = f" Simulations with a violation that does not count: {apart}."
        advice = "Count more if these matter (`counts: any`), widen the space, or raise the budget."
    else:
        found = ""
        advice = (
            "Look whether the candidates meet the ego at all, widen the space, raise the budget, "
            "or count more."
        )
    return CampaignWarning(
        code=WarningCode.NONE_FAILS,
        message=f"No failure in {judged} simulations: if they were drawn at random, at most "
        f"{100.0 * upper_bound(judged):.2g} % of such simulations fail (95 % confidence).{found}",
        advice=advice,
        page=f"{PAGE}#nothing-fails",
    )
