"""The client of a command: of a service, or of the application in the command's own process."""

from __future__ import annotations

import contextlib
import gc
import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

from drivora_service.cli.terminal.output import note
from drivora_service.errors import ConfigurationError, ServiceError

if TYPE_CHECKING:
    from drivora_service.client import Client
    from drivora_service.settings import Settings

_NEW_OBJECTS = 50_000
"""Objects that a command makes, fewer those that are gone, before unreachable ones are sought."""

_RETRY_S = 20.0
"""Seconds for which a command asks a service again that does not answer."""


@contextmanager
def interrupt_on_sigterm() -> Iterator[None]:
    """Handles the first request to terminate (SIGTERM) as an interrupt, and ignores later ones.

    A supervisor may send several at once, and what the interrupt ends must be ended in order.
    """
    requested = False

    def interrupt(_number: int, _frame: FrameType | None) -> None:
        nonlocal requested
        if not requested:
            requested = True
            raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


@contextmanager
def open_client(
    server: str,
    data_dir: Path | None,
    *,
    works: bool = False,
    makes_data: bool = False,
    workers: int | None = None,
    evaluator: str = "",
    executor: str | None = None,
    ray_address: str | None = None,
    on_error: Callable[[BaseException], None] = lambda _error: None,
) -> Iterator[Client]:
    """Opens a client, and closes it at the end; runs in this process end with it.

    A request to terminate (SIGTERM) is an interrupt meanwhile.

    Args:
        server: Address of a service; "": this process does the work.
        data_dir: Data folder in that case; ``None``: the one of the environment.
        works: Whether runs will be made, so that worker processes may get ready meanwhile.
        makes_data: Whether data folder and database are made if they do not exist.
        workers: Worker processes in this process.
        evaluator: Evaluator of campaigns in this process.
        executor: Where this process performs runs; ``None``: as the environment says.
        ray_address: Address of the Ray cluster; ``None``: as the environment says.
        on_error: Called with the error that stopped a campaign in this process.

    Raises:
        ConfigurationError: Options for work in this process were given for a service, or options
            that exclude one another.
    """
    if server:
        _refuse_local_options(data_dir, workers, evaluator)
        _refuse_executor(executor, ray_address)
    # Nearly all objects of a command's start live to its end, and each collection visits them.
    gc.set_threshold(_NEW_OBJECTS)
    from drivora_service.cli.application.installation import settings_for
    from drivora_service.logs import configure_logs

    settings = settings_for(data_dir, workers=workers, executor=executor, ray_address=ray_address)
    # What is no fault is of no use beside the results, unless it is asked for.
    is_asked = "log_level" in settings.model_fields_set
    configure_logs(form=settings.log_format, level=settings.log_level if is_asked else "error")
    if server:
        from drivora_service.client import Client

        with (
            interrupt_on_sigterm(),
            Client(server, retry_s=_RETRY_S, on_retry=_say_retry) as client,
        ):
            yield client
        return
    from drivora_service.cli.terminal.private_files import private_files

    with private_files():
        yield from _open_in_process(
            settings,
            works=works,
            makes_data=makes_data,
            workers=workers,
            evaluator=evaluator,
            on_error=on_error,
        )


def _open_in_process(
    settings: Settings,
    *,
    works: bool,
    makes_data: bool,
    workers: int | None,
    evaluator: str,
    on_error: Callable[[BaseException], None],
) -> Iterator[Client]:
    with contextlib.ExitStack() as stack:
        if works and settings.executor == "local":
            from drivora_service.cli.terminal.process_limits import check_process_limits

            check_process_limits()
            from drivora_service.cli.terminal.start_progress import start_progress
            from drivora_service.execution.fork_server import prepare_processes

            stack.enter_context(start_progress())
            # Processes start while this one reads and checks the documents.
            prepare_processes()
        yield from _open_application(
            settings,
            makes_data=makes_data,
            workers=workers,
            evaluator=evaluator,
            on_error=on_error,
        )


def _open_application(
    settings: Settings,
    *,
    makes_data: bool,
    workers: int | None,
    evaluator: str,
    on_error: Callable[[BaseException], None],
) -> Iterator[Client]:
    from drivora_service.client import ApplicationTransport, Client
    from drivora_service.command_app import LOCAL_EVALUATOR, create_command_app

    evaluator = evaluator or LOCAL_EVALUATOR
    if settings.executor != "local" and evaluator != LOCAL_EVALUATOR:
        raise ConfigurationError(
            f"--evaluator {evaluator} performs runs itself, and would not use the executor "
            f"{settings.executor!r} (--executor or DRIVORA_EXECUTOR). Leave out one of them"
        )
    app = create_command_app(
        settings,
        workers=workers,
        evaluator=evaluator,
        makes_data=makes_data,
        on_error=on_error,
    )
    with interrupt_on_sigterm(), Client(transport=ApplicationTransport(app)) as client:
        yield client


def _refuse_local_options(data_dir: Path | None, workers: int | None, evaluator: str) -> None:
    if data_dir is not None:
        raise ConfigurationError(
            f"--data-dir is for work in this process, and {_server_source()}: the service at that "
            "address has a data folder of its own. Leave out --data-dir, or give --server '' to "
            "work here"
        )
    if workers is not None or evaluator:
        raise ConfigurationError(
            f"--workers and --evaluator are for work in this process, and {_server_source()}; a "
            "service has its own workers, and a campaign may want fewer of them (`workers` in its "
            "file). Leave them out, or give --server '' to work here"
        )


def _refuse_executor(executor: str | None, ray_address: str | None) -> None:
    if executor is not None or ray_address is not None:
        raise ConfigurationError(
            f"--executor and --ray-address are for work in this process, and {_server_source()}; "
            "a service has an executor of its own. Leave them out, or give --server '' to work here"
        )


def _server_source() -> str:
    """Says where the address of the service comes from."""
    return "DRIVORA_SERVER is set" if os.environ.get("DRIVORA_SERVER") else "--server is given"


def _say_retry(error: ServiceError, seconds: float) -> None:
    note(f"{error}; trying again in {seconds:.1f} s")
