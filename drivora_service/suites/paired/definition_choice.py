"""The definition by which the runs of two batches are counted alike."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

from drivora_service.oracles.verdicts.failure_definition import (
    DEFAULT_DEFINITION,
    DefinitionOrigin,
    FailureDefinition,
    KnownFailure,
    StatedDefinition,
    state_definition,
)
from drivora_service.suites.paired.failure_rules import Rules
from drivora_service.suites.paired.pairing import Pair

_MOST_NAMED = 5
"""Differences that are written out, and scenarios and known failures of one."""


def choose_definition(
    pairs: Sequence[Pair], rules: Rules
) -> tuple[Rules, StatedDefinition, tuple[str, ...]]:
    """Returns the rules by which both runs of a pair are judged alike, with remarks on them.

    Args:
        pairs: The pairs that are compared.
        rules: What was asked for.
    """
    if rules.definition is not None:
        return rules, state_definition((rules.definition,), DefinitionOrigin.REQUEST), ()
    if rules.oracles:
        return _choose_for_oracles(pairs, rules)
    if all(pair.a.definition == pair.b.definition for pair in pairs):
        return rules, state_definition(pair.a.definition for pair in pairs), ()
    remark = (
        f"A and B were posted with different definitions of a failure: {_describe(pairs)}. The "
        "default counts here, unless `counts` says otherwise."
    )
    default = replace(rules, definition=DEFAULT_DEFINITION)
    return default, state_definition((), DefinitionOrigin.DEFAULT), (remark,)


def _choose_for_oracles(
    pairs: Sequence[Pair], rules: Rules
) -> tuple[Rules, StatedDefinition, tuple[str, ...]]:
    """Returns the rules for the oracles that were asked for, by `counts` of the runs."""
    oracles = tuple(sorted(set(rules.oracles)))
    defined = sorted({run.definition.counts for pair in pairs for run in (pair.a, pair.b)})
    remarks: tuple[str, ...] = ()
    if len(defined) == 1:
        (counts,) = defined
        if counts is not DEFAULT_DEFINITION.counts:
            remarks = (
                f"only the oracles were asked for here: `counts` is {counts}, as defined where the "
                "runs were posted",
            )
    else:
        counts = DEFAULT_DEFINITION.counts
        if defined:
            remarks = (
                f"the runs were posted with different `counts` ({', '.join(defined)}). The "
                f"default, {counts}, counts here, unless `counts` says otherwise.",
            )
    definition = FailureDefinition(counts=counts, oracles=oracles)
    chosen = replace(rules, definition=definition)
    return chosen, state_definition((definition,), DefinitionOrigin.REQUEST), remarks


def _describe(pairs: Sequence[Pair]) -> str:
    """Names in what the definitions of A and B differ, and in which scenarios."""
    different: dict[str, dict[str, None]] = {}
    for pair in pairs:
        words = "; ".join(_differences(pair.a.definition, pair.b.definition))
        if words:
            different.setdefault(words, {})[pair.scenario] = None
    named = [f"{words} (in {_some(names)})" for words, names in different.items()]
    more = f"; and {len(named) - _MOST_NAMED} more differences" if named[_MOST_NAMED:] else ""
    return "; ".join(named[:_MOST_NAMED]) + more


def _differences(a: FailureDefinition, b: FailureDefinition) -> Iterator[str]:
    """Yields each part in which two definitions differ, in words."""
    if a.counts is not b.counts:
        yield f"A counts {a.counts}, and B counts {b.counts}"
    if a.oracles != b.oracles:
        yield f"A counts {_oracles(a)}, and B counts {_oracles(b)}"
    for side, one, other in (("A", a, b), ("B", b, a)):
        known = [_known(failure) for failure in one.known if failure not in other.known]
        if known:
            yield f"known in {side} only: {_some(known)}"


def _oracles(definition: FailureDefinition) -> str:
    if definition.oracles is None:
        return "all oracles but observations"
    return ", ".join(one.replace("_", " ") for one in definition.oracles)


def _known(failure: KnownFailure) -> str:
    oracle = failure.oracle.replace("_", " ") or "any failure"
    ego = f" of {failure.ego}" if failure.ego else ""
    other = f" with {failure.counterpart}" if failure.counterpart else ""
    agents = f" by {', '.join(failure.agents)}" if failure.agents else ""
    return f"{oracle}{ego}{other}{agents}"


def _some(names: Collection[str]) -> str:
    shown = ", ".join(list(names)[:_MOST_NAMED])
    more = len(names) - _MOST_NAMED
    return f"{shown} and {more} more" if more > 0 else shown
