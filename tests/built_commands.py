"""The commands of ``drivora``, built once by the fork server of the tests.

Each process of a command would build all eighty, from their annotations, to run one.
"""

from __future__ import annotations

import typer.main

from drivora_service.cli.main import app

COMMANDS = typer.main.get_command(app)
