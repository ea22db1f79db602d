"""``drivora doctor``."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.options import DataDirOption
from drivora_service.cli.terminal.output import JsonOption, print_json, say

if TYPE_CHECKING:
    from drivora_service.cli.doctor.findings import Check, Finding

_STATE_WIDTH, _SUBJECT_WIDTH = 9, 17
_NARROWEST = 50


def doctor(
    data_dir: DataDirOption = None,
    port: Annotated[
        int | None, typer.Option(min=0, max=65535, help="Port of a service [default: 8000].")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Checks this installation; exits with 3 if there is a problem.

    Nothing is changed. The text has no secrets and can be pasted into a bug report: tokens and
    passwords are left out, and your home folder is ~.
    """
    from drivora_service.cli.doctor.findings import State, perform_checks

    findings = perform_checks(_checks(data_dir, port))
    counts = Counter(finding.state for finding in findings)
    if as_json:
        print_json(
            {
                "problems": counts[State.PROBLEM],
                "notes": counts[State.NOTE],
                "findings": [
                    {
                        "subject": finding.subject,
                        "state": finding.state.value,
                        "found": finding.found,
                        "remedy": finding.remedy,
                    }
                    for finding in findings
                ],
            }
        )
    else:
        for line in _lines(findings):
            say(line)
        say(f"\n{_total(counts[State.PROBLEM], 'problem')}, {_total(counts[State.NOTE], 'note')}")
    if counts[State.PROBLEM]:
        raise typer.Exit(ExitCode.NOT_DONE)


def _checks(data_dir: Path | None, port: int | None) -> Sequence[Check]:
    """Returns all checks. What settings cannot be read for is one problem, and the rest goes on."""
    from drivora_service.cli.doctor import software_checks
    from drivora_service.cli.doctor.findings import Check, problem

    def of_machine() -> Sequence[Check]:
        from drivora_service.cli.doctor import machine_checks

        return machine_checks.CHECKS

    def of_settings() -> Sequence[Check]:
        from drivora_service.cli.doctor.data_checks import data_checks
        from drivora_service.cli.doctor.plugin_checks import plugin_checks
        from drivora_service.settings import load_settings

        settings = load_settings(data_dir=data_dir, port=port)
        return (*data_checks(settings), *plugin_checks(settings))

    checks = [*software_checks.CHECKS]
    for subject, find_checks in (("machine", of_machine), ("settings", of_settings)):
        try:
            checks += find_checks()
        except Exception as error:
            fault = f"{type(error).__name__}: {error}"

            found = [problem(subject, fault, "Mend it; its other checks need it")]
            checks.append(Check(subject, partial(list, found)))
    return checks


def _total(count: int, word: str) -> str:
    return f"{count or 'no'} {word}{'' if count == 1 else 's'}"


def _lines(findings: Sequence[Finding]) -> list[str]:
    """Returns the findings as lines that fit the terminal, with remedies below what was found."""
    import shutil
    import textwrap

    indent = " " * (_STATE_WIDTH + _SUBJECT_WIDTH)
    width = max(_NARROWEST, shutil.get_terminal_size((100, 24)).columns)

    def wrap(text: str, first: str, later: str) -> list[str]:
        return textwrap.wrap(
            text,
            width,
            initial_indent=first,
            subsequent_indent=later,
            break_long_words=False,
            break_on_hyphens=False,
        )

    lines = []
    for finding in findings:
        head = f"{finding.state:<{_STATE_WIDTH}}{finding.subject:<{_SUBJECT_WIDTH}}"
        lines += wrap(finding.found, head, indent)
        if finding.remedy:
            lines += wrap(finding.remedy, f"{indent}→ ", f"{indent}  ")
    return lines
