"""Other spellings of commands that users type: singular for plural, and the other way round."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from typer.core import TyperGroup

ALIASES: Mapping[str, str] = {
    "agent": "agents",
    "batch": "batches",
    "campaigns": "campaign",
    "example": "examples",
    "failure": "failures",
    "law": "laws",
    "minimise": "minimize",
    "network": "networks",
    "oracle": "oracles",
    "seed": "seeds",
    "studies": "study",
    "suites": "suite",
    "tester": "testers",
    "token": "tokens",
}
"""Other spellings, and the commands that are meant."""
_RUN, _RUNS = "run", "runs"


class AliasedCommands(TyperGroup):
    """The commands of the program, each also by its other spelling, which the help leaves out.

    ``run show RUN`` is ``runs show RUN``, unless there is a file or folder ``show`` to run.
    """

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Returns the command that arguments begin with, by any spelling, and the others."""
        first, *others = args or [""]
        if first not in self.commands and first in ALIASES:
            args = [ALIASES[first], *others]
        elif first == _RUN and others and self._is_of_runs(others[0]):
            args = [_RUNS, *others]
        return super().resolve_command(ctx, args)

    def _is_of_runs(self, word: str) -> bool:
        runs = self.commands.get(_RUNS)
        return isinstance(runs, TyperGroup) and word in runs.commands and not Path(word).exists()
