"""Notes on comparisons of searches that started from known candidates."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from drivora_service.studies.comparison.compared_subjects import Compared

_MOST_NAMED = 3


def start_notes(campaigns: Sequence[Compared]) -> Iterator[str]:
    """Yields a note for each seed scenario with campaigns that started from known candidates."""
    for scenario in dict.fromkeys(one.subject.scenario for one in campaigns):
        here = [one for one in campaigns if one.subject.scenario == scenario]
        starts: dict[str, dict[str, None]] = {}
        for one in here:
            start = one.document.tester.start_from
            if start is not None:
                starts.setdefault(one.subject.method, {})[start.words] = None
        if not starts:
            continue
        told = "; ".join(f"{method}: {_join(words)}" for method, words in starts.items())
        cold = [m for m in dict.fromkeys(one.subject.method for one in here) if m not in starts]
        effect = (
            "what those campaigns had found is counted for these methods again, and not for "
            f"{', '.join(cold)}, which started from nothing: that is a difference of the start, "
            "and not of the method"
            if cold
            else "all methods did"
        )
        yield f"{scenario}: searches started from known candidates ({told}); {effect}"


def _join(words: dict[str, None]) -> str:
    listed = list(words)
    more = len(listed) - _MOST_NAMED
    return ", ".join(listed[:_MOST_NAMED]) + (f" and {more} more" if more > 0 else "")
