"""Replays as commands print them."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Sequence

from drivora_service.cli.terminal.output import print_table, say
from drivora_service.observations.differences.compared_signals import Value
from drivora_service.suites.replay.replay_records import Divergence, Replay, ReplayOutcome

_MOST_SIGNALS = 10
_MOST_CHARACTERS = 100
"""Of a text that two runs have not in common, such as a list of actors."""


def print_replays(replays: Sequence[Replay]) -> None:
    """Prints a row a run, what is to be said of those that are not identical, and the numbers."""
    print_table(
        "",
        ("run", "label", "agent", "outcome", "first difference"),
        (
            (
                replay.run.id,
                replay.run.label or "-",
                replay.run.configuration,
                replay.outcome.replace("_", " "),
                "-" if replay.divergence is None else _place(replay.divergence),
            )
            for replay in replays
        ),
        wrap=("agent", "first difference"),
        cut=("label",),
    )
    for replay in replays:
        for line in _remarks(replay):
            say(line)
    counts = Counter(replay.outcome for replay in replays)
    numbers = (f"{one.replace('_', ' ')}: {counts[one]}" for one in ReplayOutcome)
    say(f"Runs: {len(replays)}; {'; '.join(numbers)}")


def _remarks(replay: Replay) -> Iterator[str]:
    if replay.reason:
        yield f"{replay.run.id}: {replay.reason}"
    elif replay.outcome is ReplayOutcome.DIVERGED or replay.verdicts:
        yield f"{replay.run.id}:"
    if replay.outcome is ReplayOutcome.DIVERGED and replay.replay is not None:
        yield f"  replay: {replay.replay.id}"
    if replay.divergence is not None:
        yield from _differences(replay.divergence)
    for fact in replay.facts:
        yield f"  {fact.fact}: {_short(fact.original)}, replayed {_short(fact.replayed)}"
    for version in replay.versions:
        before, after = version.original or "none", version.replayed or "none"
        yield f"  version of {version.name}: {before}, replayed {after}"
    for change in replay.verdicts:
        verdicts = f"{change.before}, replayed {change.after}"
        yield f"  verdict of {change.oracle} on {change.ego}: {verdicts}"
    for file in replay.files:
        yield f"  {file}"


def _differences(divergence: Divergence) -> Iterator[str]:
    yield f"  first difference: {_place(divergence)}"
    yield (
        f"  in this frame {divergence.signals} signal(s) of {divergence.actors} actor(s) differ:"
    )
    for one in divergence.differences[:_MOST_SIGNALS]:
        named = f"{one.actor} {one.signal}".strip()
        yield f"    {named}: {_text(one.original)}, replayed {_text(one.replayed)}"
    if divergence.signals > _MOST_SIGNALS:
        yield f"    and {divergence.signals - _MOST_SIGNALS} more; --json has all"


def _place(divergence: Divergence) -> str:
    """Returns frame, actor and signal in words."""
    at = "" if divergence.time is None else f" ({divergence.time:g} s)"
    named = f"{divergence.actor} {divergence.signal}".strip()
    return f"frame {divergence.step}{at}, {named}"


def _text(value: Value) -> str:
    """Returns a value with all its digits: the difference may be in the last one."""
    if value is None:
        return "none"
    return _short(value) if isinstance(value, str) else json.dumps(value)


def _short(text: str) -> str:
    return text if len(text) <= _MOST_CHARACTERS else f"{text[:_MOST_CHARACTERS]}…"
