"""Judging and measuring a run by the code of packages, after that of Drivora."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from drivora_service.adversaries.playing import Table
from drivora_service.errors import OracleError
from drivora_service.metrics.installed_metrics import InstalledMetric, measure_installed
from drivora_service.observations.run_view import RunView
from drivora_service.oracles.built_in import judge_all
from drivora_service.oracles.installed_oracles import InstalledOracle, objective_values
from drivora_service.oracles.verdict import Verdict
from drivora_service.runs.run_report import RunReport
from drivora_service.worker.objective_measuring import Measuring


def judge_by_plugins(
    report: RunReport,
    run: RunView,
    *,
    oracles: Sequence[InstalledOracle],
    metrics: Sequence[InstalledMetric],
    measuring: Measuring | None,
    tables: Mapping[str, Table],
) -> RunReport:
    """Returns a report with what plug-ins say of the run.

    Args:
        report: The report with the verdicts, metrics and scores of Drivora.
        run: The run.
        oracles: Oracles of packages.
        metrics: Metrics of packages.
        measuring: Measures the run for a tester; ``None``: no tester asked for it.
        tables: Features of the run that an adversary gives.

    Raises:
        PluginError: One of them raised, or its answer violates the protocol.
    """
    verdicts = judge_all(run.trace, run.network, oracles, view=run)
    report = replace(
        report,
        verdicts=(*report.verdicts, *verdicts),
        metrics={**report.metrics, **measure_installed(metrics, run)},
        scores=_add_oracle_objectives(report.scores, oracles, verdicts, run),
    )
    if measuring is None:
        return report
    # Last, since a tester may be led by any of the others.
    measured = measuring.measure(report, run)
    return replace(report, measurement=replace(measured, features={**measured.features, **tables}))


def _add_oracle_objectives(
    scores: Mapping[str, float | None],
    oracles: Sequence[InstalledOracle],
    verdicts: Sequence[Verdict],
    run: RunView,
) -> dict[str, float | None]:
    """Returns the scores of a run with the objectives of oracles of packages.

    Raises:
        OracleError: Two objectives have the same name.
    """
    found = dict(scores)
    egos = [ego.id for ego in run.egos]
    for oracle in oracles:
        own = (verdict for verdict in verdicts if verdict.oracle == oracle.name)
        for name, value in objective_values(oracle.objectives, own, egos).items():
            if name in found:
                raise OracleError(
                    f"oracle {oracle.name!r} of the package {oracle.package!r} has the objective "
                    f"{name!r}, and so has another oracle, or Drivora; give it another name",
                    cause="oracle_plugin",
                )
            found[name] = value
    return found
