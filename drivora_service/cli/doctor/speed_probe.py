"""Measures how fast this machine simulates and judges; a process of ``drivora doctor``."""

from __future__ import annotations

import json


def measure_speed() -> dict[str, float]:
    """Simulates a generated scenario twice; returns figures of the second run.

    Returns:
        ``sim_time_s``: simulated seconds; ``factor``: those a second of the whole run, in which it
        is also planned and judged; ``step_us``: microseconds a step.

    Raises:
        RuntimeError: The run did not finish.
    """
    from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
    from drivora_service.runs.run_report import RunSpec, RunStatus
    from drivora_service.scenario.canonical import canonical_json
    from drivora_service.scenario.check_warm_up import warm_up_checks
    from drivora_service.worker.performing import perform
    from drivora_service.worker.setup import WorkerSetup

    setup = WorkerSetup(shipped_networks=shipped_networks(), installed_oracles=False)
    scenario = warm_up_checks(NetworkCatalogue(setup.shipped_networks))
    spec = RunSpec(run_id="doctor", document=canonical_json(scenario))
    # The first run loads the kernels.
    perform(spec, setup)
    report = perform(spec, setup)
    if report.status is not RunStatus.FINISHED:
        reason = "" if report.failure is None else report.failure.message
        raise RuntimeError(f"the run ended as {report.status}: {reason}")
    return {
        "sim_time_s": report.sim_time_s,
        "factor": report.sim_time_s / report.wall_time_s,
        "step_us": report.step_cost_us,
    }


if __name__ == "__main__":
    print(json.dumps(measure_speed()))
