"""Imports that every worker needs, made once by the fork server and inherited by workers.

A worker is then ready in a fraction of the seconds that they take, which matters where code under
test keeps crashing, and on machines with many slots. Nothing of a user's run is loaded here, and no
agent or oracle from outside this package.
"""

from __future__ import annotations

import contextlib
import gc
import os

# The fork server may still be importing when its owner has ended; a reader of the owner's output
# must not wait for it. Workers write to logs of their own.
_nowhere = os.open(os.devnull, os.O_WRONLY)
os.dup2(_nowhere, 1)
os.dup2(_nowhere, 2)
os.close(_nowhere)

# An import that fails here fails again in the worker, where it is reported.
with contextlib.suppress(Exception):
    from drivora_service.agents.built_in_agents import import_agents
    from drivora_service.compilation.compilation_progress import note_ready
    from drivora_service.networks.catalogue import shipped_networks
    from drivora_service.runs.run_report import RunReport, RunStatus
    from drivora_service.worker.setup import WorkerSetup
    from drivora_service.worker.worker_messages import frame_of_report
    from drivora_service.worker.worker_warm_up import warm_up

    import_agents()
    warm_up(WorkerSetup(shipped_networks=shipped_networks(), installed_oracles=False))
    # The first report compiles how reports are written.
    frame_of_report(RunReport(run_id="warm-up", status=RunStatus.FINISHED))
    note_ready()

# Collections of garbage in workers would visit all of it, and so copy the memory that they share.
gc.collect()
gc.freeze()
