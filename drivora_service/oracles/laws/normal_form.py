"""Negations of formulas, and the ways in which a law can be violated.

After LawBreaker (Sun et al., ASE 2022): the negation of a law is split into sub-violations, each a
way of its own to violate the law, which together are the negation.
"""

from __future__ import annotations

from itertools import chain, combinations, product

from drivora_service.oracles.laws.formula import (
    And,
    Comparison,
    Flag,
    Formula,
    Implies,
    Not,
    Or,
    Temporal,
    Until,
)


def normal_form(formula: Formula, *, negated: bool = False) -> Formula:
    """Returns an equivalent formula, or its negation, with negations of comparisons and flags only.

    The temporal operators swap with their duals: ``not always`` is ``eventually not``.
    """
    match formula:
        case Comparison():
            return formula.negate() if negated else formula
        case Flag():
            return Flag(signal=formula.signal, holds=formula.holds is not negated)
        case Not():
            return normal_form(formula.inner, negated=not negated)
        case Implies():
            condition = normal_form(formula.condition, negated=not negated)
            consequence = normal_form(formula.consequence, negated=negated)
            return _join(And if negated else Or, (condition, consequence))
        case And() | Or():
            parts = tuple(normal_form(part, negated=negated) for part in formula.parts)
            return _join(And if isinstance(formula, And) is not negated else Or, parts)
        case Temporal():
            return Temporal(
                window=formula.window.dual if negated else formula.window,
                interval=formula.interval,
                inner=normal_form(formula.inner, negated=negated),
            )
        case Until():
            return Until(
                left=normal_form(formula.left, negated=negated),
                right=normal_form(formula.right, negated=negated),
                interval=formula.interval,
                dual=formula.dual is not negated,
            )


def sub_violations(formula: Formula) -> tuple[Formula, ...]:
    """Returns the ways in which a formula can be violated; their disjunction is its negation."""
    return tuple(dict.fromkeys(_cases(normal_form(formula, negated=True))))


def count_sub_violations(formula: Formula) -> int:
    """Returns how many ways :func:`sub_violations` would find, without making them."""
    return _count(normal_form(formula, negated=True))


def _cases(formula: Formula) -> tuple[Formula, ...]:
    """Splits a formula in normal form into cases whose disjunction it is."""
    match formula:
        case Or():
            return tuple(
                chain.from_iterable(
                    _cases_where(formula.parts, chosen)
                    for size in range(1, len(formula.parts) + 1)
                    for chosen in combinations(range(len(formula.parts)), size)
                )
            )
        case And():
            return tuple(
                _join(And, parts) for parts in product(*(_cases(part) for part in formula.parts))
            )
        case Temporal(window=window) if not window.is_universal:
            return tuple(
                Temporal(window=window, interval=formula.interval, inner=case)
                for case in _cases(formula.inner)
            )
        case Until(dual=False):
            return tuple(
                Until(left=formula.left, right=case, interval=formula.interval)
                for case in _cases(formula.right)
            )
        case _:
            # "Always this or that" is not "always this, or always that".
            return (formula,)


def _cases_where(parts: tuple[Formula, ...], chosen: tuple[int, ...]) -> tuple[Formula, ...]:
    """Returns the cases in which exactly the chosen parts of a disjunction hold."""
    others = tuple(
        normal_form(part, negated=True) for place, part in enumerate(parts) if place not in chosen
    )
    return tuple(
        _join(And, (*held, *others)) for held in product(*(_cases(parts[c]) for c in chosen))
    )


def _count(formula: Formula) -> int:
    match formula:
        case Or():
            # Each part has its cases, or does not hold; at least one holds.
            total = 1
            for part in formula.parts:
                total *= 1 + _count(part)
            return total - 1
        case And():
            total = 1
            for part in formula.parts:
                total *= _count(part)
            return total
        case Temporal(window=window) if not window.is_universal:
            return _count(formula.inner)
        case Until(dual=False):
            return _count(formula.right)
        case _:
            return 1


def _join(kind: type[And] | type[Or], parts: tuple[Formula, ...]) -> Formula:
    """Returns a conjunction or disjunction whose parts are not of the same kind; none twice."""
    flat: dict[Formula, None] = {}
    for part in parts:
        flat.update(dict.fromkeys(part.parts if isinstance(part, kind) else (part,)))
    return next(iter(flat)) if len(flat) == 1 else kind(parts=tuple(flat))
