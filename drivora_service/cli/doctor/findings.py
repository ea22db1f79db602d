"""What a check of an installation finds."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path


class State(StrEnum):
    """How bad a finding is."""

    OK = "ok"
    NOTE = "note"
    PROBLEM = "problem"


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """What a check has found about one thing.

    Attributes:
        subject: The thing, in one or two words.
        state: How bad it is.
        found: What was found.
        remedy: What to do; "" if nothing has to be done.
    """

    subject: str
    state: State
    found: str
    remedy: str = ""


@dataclass(frozen=True, slots=True)
class Check:
    """A check of one thing.

    Attributes:
        subject: The thing, also where the check itself fails.
        find: Returns the findings; may raise anything.
    """

    subject: str
    find: Callable[[], Iterable[Finding]]


_USER_AND_PASSWORD = re.compile(r"(://)[^/@\s]*@")


def ok(subject: str, found: str) -> Finding:
    """Returns a finding that is as it should be."""
    return Finding(subject=subject, state=State.OK, found=found)


def noted(subject: str, found: str, remedy: str = "") -> Finding:
    """Returns a finding that may surprise, but prevents nothing."""
    return Finding(subject=subject, state=State.NOTE, found=found, remedy=remedy)


def problem(subject: str, found: str, remedy: str) -> Finding:
    """Returns a finding that prevents something, with what to do."""
    return Finding(subject=subject, state=State.PROBLEM, found=found, remedy=remedy)


def perform_checks(checks: Iterable[Check]) -> list[Finding]:
    """Performs checks; one that raises is a problem of its subject and prevents no other.

    Returns:
        The findings, fit to be published: without passwords in addresses and without the name of
        the user's home folder.
    """
    findings: list[Finding] = []
    for check in checks:
        try:
            findings += check.find()
        except (Exception, SystemExit) as error:
            findings.append(
                problem(
                    check.subject,
                    f"the check failed: {type(error).__name__}: {error}",
                    "If the message does not say what to do, report it with all of this text",
                )
            )
    return [
        replace(
            finding,
            found=publishable(finding.found),
            remedy=publishable(finding.remedy),
        )
        for finding in findings
    ]


def publishable(text: str) -> str:
    """Returns a text without users and passwords in addresses, the home folder as ``~``."""
    text = _USER_AND_PASSWORD.sub(r"\1", text)
    home = str(Path.home())
    return text if home == "/" else re.sub(rf"{re.escape(home)}(?=[/\s,;:)'\"]|$)", "~", text)
