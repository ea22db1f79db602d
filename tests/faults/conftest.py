"""The service that the rows of the fault matrix share, and the table of their results."""

from __future__ import annotations

import os
import random
from collections.abc import Callable, Generator, Iterator, Sequence
from pathlib import Path

import pytest

from tests.faults.invariants import Hashes, Judgement, judge, undisturbed
from tests.faults.matrix import table
from tests.faults.service_under_test import Service, Work
from tests.faults.work import KINDS, SLOW, good_runs

TRIALS = int(os.environ.get("TRIALS", "1"))
Judge = Callable[..., Judgement]


class Shared:
    """A service that goes from test to test, and is replaced once it is not well."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._number = 0
        self._service: Service | None = None
        self.hashes: Hashes = {}

    def get(self) -> Service:
        """Returns a service that is ready and has nothing to do."""
        if self._service is not None and not self._service.is_ready():
            self.discard()
        if self._service is None:
            self._number += 1
            self._service = Service(self._folder / f"service-{self._number}")
            self._service.start()
        if not self.hashes:
            some = [*good_runs(KINDS), *good_runs(1, agent=SLOW)]
            self.hashes = undisturbed(self._service, self._service.post(some))
        return self._service

    def discard(self) -> None:
        """Ends the service; the next test gets another one."""
        if self._service is not None:
            self._service.stop()
        self._service = None


def pytest_collection_modifyitems(items: Sequence[pytest.Item]) -> None:
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker(pytest.mark.faults)


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "trial" in metafunc.fixturenames:
        metafunc.parametrize("trial", range(TRIALS))


@pytest.fixture(scope="session")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Shared]:
    services = Shared(tmp_path_factory.mktemp("shared"))
    yield services
    services.discard()


@pytest.fixture
def trial() -> int:
    """Which of the trials of a row this is."""
    return 0


@pytest.fixture
def luck(request: pytest.FixtureRequest, trial: int) -> random.Random:
    """Draws the moments of faults, others in each trial."""
    return random.Random(f"{request.node.originalname}-{trial}")


@pytest.fixture
def service(shared: Shared, request: pytest.FixtureRequest) -> Iterator[Service]:
    """A service with two workers that other tests use as well."""
    yield shared.get()
    report = request.node.stash.get(OUTCOME, None)
    if report is None or not report.passed:
        shared.discard()


@pytest.fixture
def own_service(tmp_path: Path) -> Iterator[Service]:
    """A service that is not started yet."""
    service = Service(tmp_path)
    yield service
    service.stop()


@pytest.fixture
def check(shared: Shared, record_property: Callable[[str, object], None]) -> Judge:
    """Judges some work and fails the test if any invariant is broken."""
    if not shared.hashes:
        shared.get()

    def checked(service: Service, work: Work, *, seconds: float = 100.0) -> Judgement:
        judgement = judge(service, work, shared.hashes, seconds=seconds)
        for name in ("lost", "twice", "blamed", "back"):
            record_property(name, getattr(judgement, name))
        assert judgement.is_clean, judgement
        return judgement

    return checked


OUTCOME = pytest.StashKey[pytest.TestReport]()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    if report.when == "call":
        item.stash[OUTCOME] = report
    return report


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    reports = [
        report
        for outcome in ("passed", "failed")
        for report in terminalreporter.stats.get(outcome, [])
        if "tests/faults/" in report.nodeid
    ]
    if not reports:
        return
    text = table(reports)
    terminalreporter.write_line(text)
    if path := os.environ.get("FAULT_TABLE"):
        Path(path).write_text(text)
