"""An oracle of an installed package, whose answers are checked."""

from __future__ import annotations

import math
import traceback
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from drivora_service.errors import OracleError
from drivora_service.foreign_errors import describe_exception
from drivora_service.oracles.verdict import Oracle, Outcome, Verdict
from drivora_service.oracles.verdicts.verdict_json import plain_verdict
from drivora_service.oracles.verdicts.violation_magnitude import DECLARED, declared_magnitude
from drivora_service.plugin_table import describe_plugin

if TYPE_CHECKING:
    from drivora_service.observations.run_view import RunView

_LOG = 4000
"""Maximum length of a kept traceback, characters."""


@dataclass(frozen=True, slots=True, kw_only=True)
class InstalledOracle:
    """Wraps the oracle of a package; its errors name the oracle and the package.

    Attributes:
        name: Name of the oracle.
        package: Name of its package.
        oracle: The oracle.
        objectives: Names of the objectives that its verdicts have as evidence.
    """

    name: str
    package: str
    oracle: Oracle
    objectives: tuple[str, ...] = ()

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Judges a run.

        Returns:
            Verdicts that hold nothing but Python's own types.

        Raises:
            OracleError: The oracle raised, or its answer violates the protocol.
        """
        try:
            answer: Any = self.oracle.judge(run)
        except (Exception, SystemExit) as error:
            raise OracleError(
                f"{self._words} raised {describe_exception(error)}",
                cause="oracle_raised",
                log=traceback_of(error),
            ) from error
        verdicts = self._plain(answer)
        problem = next(self._problems(verdicts, run), "")
        if problem:
            raise self._refusal(problem)
        return verdicts

    @property
    def _words(self) -> str:
        return describe_plugin("oracle", self.name, self.package)

    def _plain(self, answer: Any) -> tuple[Verdict, ...]:
        """Returns a valid answer as it is read back from storage."""
        if not isinstance(answer, tuple):
            raise self._refusal(f"a {type(answer).__name__}; allowed: a tuple of Verdict")
        for part in answer:
            if not isinstance(part, Verdict):
                raise self._refusal(f"with a {type(part).__name__}; allowed: a tuple of Verdict")
        try:
            return tuple(plain_verdict(verdict) for verdict in answer)
        except Exception as error:
            # Evidence may hold objects of the package, which may raise any error when they are
            # read.
            raise self._refusal(f"a verdict that cannot be stored: {error}") from error

    def _problems(self, verdicts: tuple[Verdict, ...], run: RunView) -> Iterator[str]:
        """Yields the problems of verdicts, as ends of a sentence that begins with "answered"."""
        outcomes: dict[str, list[Outcome]] = {ego.id: [] for ego in run.egos}
        for verdict in verdicts:
            if verdict.oracle != self.name:
                yield f"in the name of {verdict.oracle!r}; allowed: its own"
            if verdict.ego not in outcomes:
                yield f"for ego {verdict.ego!r}; known: {', '.join(outcomes)}"
                continue
            if not verdict.message:
                yield "without a message"
            yield from _violation_problems(verdict, run.trace.step_count)
            yield from _objective_problems(verdict, self.objectives)
            outcomes[verdict.ego].append(verdict.outcome)
        for ego, own in outcomes.items():
            if not own:
                yield f"nothing for ego {ego!r}; each gets a verdict"
            elif len(own) > 1 and own.count(Outcome.VIOLATED) < len(own):
                yield (
                    f"{len(own)} verdicts for ego {ego!r}; allowed: several if all are violations, "
                    "else one"
                )

    def _refusal(self, problem: str) -> OracleError:
        return OracleError(
            f"{self._words} answered {problem}",
            cause="oracle_invalid_verdict",
        )


def objective_values(
    objectives: Sequence[str], verdicts: Iterable[Verdict], egos: Sequence[str]
) -> dict[str, float | None]:
    """Returns the objectives of a run that the verdicts of an oracle have as evidence.

    Args:
        objectives: Their names.
        verdicts: Verdicts of the oracle alone.
        egos: Ids of all egos.

    Returns:
        Values by name: that of the ego nearest to a violation; ``None`` if no ego has one. With
        several egos, ``name[ego id]`` is that of one of them.
    """
    own = list(verdicts)
    values: dict[str, float | None] = {}
    for name in objectives:
        found = {
            ego: min(
                (
                    float(value)
                    for one in own
                    if one.ego == ego and (value := one.evidence.get(name)) is not None
                ),
                default=None,
            )
            for ego in egos
        }
        values[name] = min((one for one in found.values() if one is not None), default=None)
        if len(egos) > 1:
            values.update({f"{name}[{ego}]": value for ego, value in found.items()})
    return values


def traceback_of(error: BaseException) -> str:
    """Returns the end of an error's traceback."""
    return "".join(traceback.format_exception(error))[-_LOG:]


def _violation_problems(verdict: Verdict, steps: int) -> Iterator[str]:
    if verdict.outcome is not Outcome.VIOLATED:
        return
    if verdict.time is None or verdict.step is None or verdict.location is None:
        yield "a violation without time, step or location"
    elif not 0 <= verdict.step < steps:
        yield f"a violation at step {verdict.step}; the run has steps 0 to {steps - 1}"
    if DECLARED in verdict.evidence and declared_magnitude(verdict.evidence) is None:
        yield (
            f"evidence {DECLARED!r} that is no measure; allowed: a name, a finite value, a margin "
            "above 0, and perhaps unit and less_is_worse"
        )


def _objective_problems(verdict: Verdict, objectives: Sequence[str]) -> Iterator[str]:
    for name in objectives:
        if name not in verdict.evidence:
            # Where there is nothing to judge, there need not be anything to measure.
            if verdict.outcome in (Outcome.PASSED, Outcome.VIOLATED):
                yield (
                    f"{verdict.outcome.in_words} without the evidence {name!r}, which is one of "
                    "its objectives; give a finite number, or None where it is not measurable"
                )
            continue
        value = verdict.evidence[name]
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if value is not None and not (is_number and math.isfinite(value)):
            yield f"{value!r} for its objective {name!r}; allowed: a finite number, or None"
