"""Fixtures shared by all tests."""

from __future__ import annotations

import logging
import os
import signal
from collections import Counter
from collections.abc import Iterator
from multiprocessing import forkserver
from pathlib import Path

import hypothesis
import pytest
import structlog

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.execution.fork_server import ENVIRONMENT
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.store.database import open_database
from drivora_service.worker.integrity import snapshot_judging_code
from tests.execution.ray_cluster import Cluster, ray_cluster
from tests.forked_service import forked_service
from tests.postgresql_server import PostgresqlServer, postgresql_server

# Machines differ in speed: a test fails for what it finds, not for how long it took to find it.
hypothesis.settings.register_profile(
    "drivora", deadline=None, suppress_health_check=[hypothesis.HealthCheck.too_slow]
)
hypothesis.settings.load_profile("drivora")

# Where the tests run in the background of a shell without job control, interrupts are ignored, and
# so they are in every process that a test starts to interrupt it.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# As every process of Drivora has it. Without it, scikit-learn asks how many processors there are,
# and warns where /sys is absent, as in some containers.
os.environ.update(ENVIRONMENT)

ROOT = Path(__file__).resolve().parents[1]


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Leaves out the modules without a slow test where only these are wanted.

    Importing them all takes longer than the shortest hundred slow tests.
    """
    if config.option.markexpr != "slow" or not collection_path.match("test_*.py"):
        return None
    text = collection_path.read_text()
    return not ("mark.slow" in text or "slow_on_postgresql" in text) or None


_LONG_S = 20.0
"""Seconds from which a test is given to a process by itself, and not with its module."""


# After those that are not wanted have been left out.
@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Lets every process begin with the longest tests, so that none is left alone with one.

    Each is given a part of the items, of the same length and in their order; those that are done
    take over the ends of others' parts.
    """
    seconds = {item: _seconds(item) for item in items}
    of_modules: Counter[Path] = Counter()
    for item in items:
        of_modules[item.path] += seconds[item]
    long = [item for item in items if seconds[item] >= _LONG_S]
    long.sort(key=lambda item: -seconds[item])
    others = [item for item in items if seconds[item] < _LONG_S]
    others.sort(key=lambda item: -of_modules[item.path])
    left, items[:] = len(items), []
    processes = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    for number in range(processes):
        own = long[number::processes]
        share = max((left - len(items)) // (processes - number) - len(own), 0)
        items += [*own, *others[:share]]
        del others[:share]
    items += others


def _seconds(item: pytest.Item) -> int:
    mark = item.get_closest_marker("slow")
    assert mark is None or not mark.args, f"{item.nodeid}: say slow(seconds=…)"
    return 0 if mark is None else int(mark.kwargs.get("seconds", 0))


_PRELOADED = (
    "__main__",
    "drivora_service.worker.preloaded",
    "drivora_service.app",
    "drivora_service.command_app",
    "drivora_service.client",
    "drivora_service.cli.main",
    "tests.built_commands",
    "drivora_service.cli.runs.file_running",
    "drivora_service.cli.campaigns.campaign_reports",
    "drivora_service.plotting.run_picture",
    # What these import only when a service answers for the first time, or a command does its work;
    # of a fork server, it is imported once and not by each.
    "drivora_service.serving",
    *(
        f"drivora_service.api.routes.{path.stem}"
        for path in sorted((ROOT / "drivora_service" / "api" / "routes").glob("[a-z]*.py"))
    ),
    "drivora_service.cli.campaigns.campaign_running",
    "drivora_service.cli.runs.replay_running",
    "drivora_service.cli.suites.suite_files",
    "drivora_service.cli.suites.suite_reports",
    "drivora_service.suites.paired.batch_pairing",
    "anyio._backends._asyncio",
    "pydantic.v1",
    "uvicorn",
    # By pyarrow, where it is installed.
    "pandas",
    # Comparisons of batches and campaigns.
    "scipy.stats",
)
"""Imports of workers, of commands and of services."""


@pytest.fixture(scope="session", autouse=True)
def _fork_server() -> None:
    """Starts the fork server of this process, without waiting for it.

    A process has one, and the first to need it chooses its imports. After a test of workers without
    any, every later worker and command would spend seconds on its own.
    """
    forkserver.set_forkserver_preload(list(_PRELOADED))
    forkserver.ensure_running()


@pytest.fixture(autouse=True)
def _own_snapshot() -> None:
    """Has what a test replaces in the package count as what is there."""
    snapshot_judging_code.cache_clear()


@pytest.fixture(autouse=True)
def _own_logs() -> Iterator[None]:
    """Has a command that runs in this process configure the logs of its own test only."""
    root = logging.getLogger()
    handlers, level = root.handlers, root.level
    yield
    if structlog.is_configured():
        root.handlers = handlers
        root.setLevel(level)
        structlog.reset_defaults()


@pytest.fixture(scope="session")
def repository() -> Path:
    """The root of the checkout."""
    return ROOT


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Real towns and routes that lie beside the checkout; tests skip where they are absent."""
    path = ROOT.parent / "shared" / "data"
    if not path.is_dir():
        pytest.skip("the real towns and routes are not beside the checkout")
    return path


@pytest.fixture(scope="session")
def catalogues() -> Catalogues:
    """What the package itself has: networks, agents, oracles, testers and feedbacks."""
    return Catalogues(NetworkCatalogue(shipped_networks()))


@pytest.fixture(scope="session")
def empty_database(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of a new database, to be copied: that is ten times as fast as making one."""
    path = tmp_path_factory.mktemp("database") / "drivora.sqlite3"
    open_database(f"sqlite:///{path}").close()
    return path


@pytest.fixture(scope="session")
def postgresql() -> Iterator[PostgresqlServer]:
    """A PostgreSQL server of this process of the tests, started when it is first needed."""
    with postgresql_server() as server:
        yield server


@pytest.fixture(scope="session")
def ray_nodes() -> Iterator[Cluster]:
    """A Ray cluster of this process of the tests, with two nodes of one CPU each."""
    with ray_cluster(1, 1) as cluster:
        yield cluster


@pytest.fixture(scope="session")
def service_url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a real service, in a process of its own and with two workers."""
    with forked_service(tmp_path_factory.mktemp("service"), workers=2) as url:
        yield url
