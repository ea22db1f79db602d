"""The verdicts on one ego, by oracle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from drivora_service.oracles.verdict import Outcome, Verdict


@dataclass(frozen=True, slots=True, kw_only=True)
class Judgement:
    """The verdicts of the oracles on one ego.

    Attributes:
        verdicts: All verdicts on the ego.
    """

    verdicts: tuple[Verdict, ...]

    @staticmethod
    def of(ego_id: str, verdicts: Sequence[Verdict]) -> Judgement:
        """Selects the verdicts on an ego."""
        return Judgement(verdicts=tuple(v for v in verdicts if v.ego == ego_id))

    def by(self, oracle: str) -> tuple[Verdict, ...] | None:
        """Returns an oracle's verdicts; ``None`` if it was not measurable or did not judge.

        A verdict that there was nothing to judge is one without a violation, as a passed one is.
        """
        found = tuple(v for v in self.verdicts if v.oracle == oracle)
        if not found or any(v.outcome is Outcome.NOT_MEASURABLE for v in found):
            return None
        return found

    def violations(self, oracle: str) -> tuple[Verdict, ...] | None:
        """Returns an oracle's verdicts of violation; ``None`` as in ``by``."""
        found = self.by(oracle)
        if found is None:
            return None
        return tuple(v for v in found if v.outcome is Outcome.VIOLATED)
