"""What every worker needs, imported once: the fork server imports this module, workers inherit it.

A worker is then ready in a fraction of the seconds that this takes, which counts where code under
test keeps crashing, and on machines with many slots. Nothing of a user's run lies in here, and no
agent and no oracle but our own.
"""

from __future__ import annotations

import contextlib
import os

# The fork server may still be importing when its owner has ended; who reads the owner's output must
# not have to wait for that. Workers write to logs of their own.
_nowhere = os.open(os.devnull, os.O_WRONLY)
os.dup2(_nowhere, 1)
os.dup2(_nowhere, 2)
os.close(_nowhere)

# What fails here fails again in the worker, where it is reported.
with contextlib.suppress(Exception):
    from drivora_service.networks.catalogue import shipped_networks
    from drivora_service.runs.report import RunReport, RunStatus
    from drivora_service.worker.messages import frame_of_report
    from drivora_service.worker.setup import WorkerSetup
    from drivora_service.worker.warm_up import warm_up

    warm_up(WorkerSetup(shipped_networks=shipped_networks(), installed_oracles=False))
    # The first report compiles how reports are written.
    frame_of_report(RunReport(run_id="warm-up", status=RunStatus.FINISHED))
