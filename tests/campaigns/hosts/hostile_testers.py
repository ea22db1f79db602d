"""A package of testers that take all memory or time, and its installation."""

from __future__ import annotations

import contextlib
import mmap
import re
import shutil
import signal
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.search.components import Components
from drivora_service.search.plugin import TesterPlugin
from drivora_service.search.tester import Evaluation, Proposal, TesterContext
from drivora_service.search.testers.random_search import RandomParameters

kept: list[object] = []


class Hostile:
    """Proposes some candidates and then never comes back."""

    def __init__(self, context: TesterContext, act: Callable[[], None], after: int) -> None:
        self._context, self._act, self._left = context, act, after

    def ask(self, room: int) -> tuple[Proposal, ...]:
        if not self._left:
            self._act()
        count = min(room, self._left)
        self._left -= count
        return tuple(
            Proposal(values=self._context.space.sample(self._context.random), origin="initial")
            for _ in range(count)
        )

    def tell(self, evaluation: Evaluation) -> None:
        pass


def loop() -> None:
    while True:
        pass


def sleep() -> None:
    time.sleep(1e6)


def ignore() -> None:
    """Ignores the request to end, and every exception that is raised in it."""
    # Not in a thread of a command.
    with contextlib.suppress(ValueError):
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
    while True:
        try:
            loop()
        except BaseException:
            continue


def match() -> None:
    """Never releases the interpreter lock, so that no signal handler of Python runs."""
    re.match(r"(a+)+$", "a" * 64 + "b")


def grow() -> None:
    while True:
        kept.append([0] * 1_000_000)


def reserve() -> None:
    kept.append(np.zeros(10**13))


def map_pages() -> None:
    """Takes pages that no limit of the process itself counts."""
    while True:
        pages = mmap.mmap(-1, 64 << 20)
        kept.append(pages)
        for place in range(0, len(pages), mmap.PAGESIZE):
            pages[place] = 1


def plugin(
    act: Callable[[], None], name: str = "", after: int = 0
) -> TesterPlugin[RandomParameters]:
    def create(
        context: TesterContext, _parameters: RandomParameters, _components: Components
    ) -> Hostile:
        return Hostile(context, act, after)

    return TesterPlugin(
        name=name or act.__name__.replace("_", "-"),
        title="Hostile",
        description="never comes back",
        source="the tests",
        parameters=RandomParameters,
        feedback=FeedbackChoice(name="general"),
        create=create,
        is_generational=False,
    )


LOOP, SLEEP, IGNORE, MATCH = plugin(loop), plugin(sleep), plugin(ignore), plugin(match)
LATER = plugin(loop, "later", after=2)
"""Loops when it is asked again, after one of two evaluations."""
GROW, RESERVE, MAP_PAGES = plugin(grow), plugin(reserve), plugin(map_pages)


def install_hostile_testers(site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Makes the testers of this module a distribution that engines find on their path."""
    info = site / "hostile_testers-1.0.dist-info"
    info.mkdir(parents=True)
    shutil.copy(__file__, site)
    names = ("loop", "sleep", "ignore", "match", "grow", "reserve", "map_pages", "later")
    points = [f"{name.replace('_', '-')} = hostile_testers:{name.upper()}" for name in names]
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: hostile-testers\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("\n".join(["[drivora_service.testers]", *points, ""]))
    monkeypatch.syspath_prepend(str(site))
