"""``drivora serve``."""

from __future__ import annotations

import os
from typing import Annotated

import typer

from drivora_service.cli.terminal.options import DataDirOption, ExecutorOption, RayAddressOption


def serve(
    host: Annotated[
        str | None, typer.Option(help="Address; beyond loopback needs API tokens.")
    ] = None,
    port: Annotated[int | None, typer.Option(min=0, max=65535, help="Port; 0: a free one.")] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            min=1, help="Worker processes, on a Ray cluster of each node [default: one a core]."
        ),
    ] = None,
    executor: ExecutorOption = None,
    ray_address: RayAddressOption = None,
    data_dir: DataDirOption = None,
    root_path: Annotated[
        str | None,
        typer.Option(help="Path that the service is under behind a proxy, such as /drivora."),
    ] = None,
    log_format: Annotated[str | None, typer.Option(help="console or json.")] = None,
    log_level: Annotated[str | None, typer.Option(help="debug, info, warning or error.")] = None,
) -> None:
    """Starts the service: HTTP API, queue and worker processes; ends on Ctrl-C or SIGTERM.

    Running runs may end then, for DRIVORA_DRAIN_S seconds; a second signal ends it at once.
    """
    from drivora_service.cli.terminal.private_files import keep_files_private
    from drivora_service.cli.terminal.process_limits import check_process_limits

    check_process_limits()
    from drivora_service.execution.fork_server import prepare_processes

    keep_files_private()
    if (executor or os.environ.get("DRIVORA_EXECUTOR", "local")) == "local":
        # Processes start while this one reads and checks its settings.
        prepare_processes()
    from drivora_service.serving import serve_until_stopped
    from drivora_service.settings import load_settings

    serve_until_stopped(
        load_settings(
            host=host,
            port=port,
            workers=workers,
            executor=executor,
            ray_address=ray_address,
            data_dir=data_dir,
            root_path=root_path,
            log_format=log_format,
            log_level=log_level,
        )
    )
