"""What the fork server of the tests leaves to commands, services and their workers.

Each process of a command would build all eighty commands, from their annotations, to run one; and
read the network on which most of them run a scenario.
"""

from __future__ import annotations

import gc

import sqlalchemy.orm
import typer.main

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.cli.main import app
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.runs.run_report import RunSpec
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.validation import validate_data
from drivora_service.worker.integrity import snapshot_judging_code
from drivora_service.worker.performing import perform
from drivora_service.worker.setup import WorkerSetup
from drivora_service.worker.worker_catalogues import networks_of

COMMANDS = typer.main.get_command(app)

_SETUP = WorkerSetup(shipped_networks=shipped_networks(), installed_oracles=False)
"""As the fork server of workers has it, whose catalogue keeps the network."""


def _read_network() -> None:
    checked = validate_data({**SCENARIO, "max_sim_time": 1.0}, networks_of(_SETUP), ("idm",))
    perform(RunSpec(run_id="preloaded", document=canonical_json(checked.scenario)), _SETUP)


_read_network()
# Of the modules of commands, too, which a worker would find changed.
snapshot_judging_code.cache_clear()
sqlalchemy.orm.configure_mappers()
gc.collect()
gc.freeze()
