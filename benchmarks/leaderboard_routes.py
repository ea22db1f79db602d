"""The CARLA Leaderboard 1.0 routes, imported and driven with background traffic.

Every route must end with a judged report; the table says what happened on each.

    python -m benchmarks.leaderboard_routes --networks MAPS --routes FILE FILE --density 3
"""

from __future__ import annotations

import argparse
import tempfile
from collections import Counter
from pathlib import Path

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.execution.executor import Limits
from drivora_service.execution.local import LocalExecutor
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.oracles.verdict import Outcome
from drivora_service.runs.report import RunReport, RunSpec, RunStatus
from drivora_service.runs.worker_setup import WorkerSetup
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.entities import BackgroundTrafficDocument
from drivora_service.scenario.importers.reading import read_scenarios
from drivora_service.scenario.validation import validate_document

_GRAVE = ("collision", "red_light", "off_road", "wrong_way")


def specs(options: argparse.Namespace, catalogue: NetworkCatalogue) -> list[RunSpec]:
    """Imports the routes, adds the traffic, validates."""
    found = []
    for file in options.routes:
        for item in read_scenarios(file.read_bytes(), name=file.stem, agent=options.agent):
            name = f"{file.stem.split('_')[1]}-{item.name}".replace("_", "-")
            if options.only and not any(name.endswith(end) for end in options.only):
                continue
            traffic = BackgroundTrafficDocument.model_validate({"density": options.density})
            document = item.document.model_copy(
                update={"background_traffic": traffic, "seed": options.seed}
            )
            valid = validate_document(document, catalogue, AgentCatalogue().names())
            for note in valid.notes:
                print(f"{name}: {note}")
            found.append(RunSpec(run_id=name, document=canonical_json(valid.scenario)))
    return found


def _row(report: RunReport) -> str:
    if report.status is not RunStatus.FINISHED:
        cause = "" if report.failure is None else report.failure.message
        return f"{report.run_id:38} {report.status.value}: {cause}"
    broken = [
        f"{v.oracle}{'' if v.at_fault is None else ' at fault' if v.at_fault else ' not at fault'}"
        f" ({v.message})"
        for v in report.verdicts
        if v.outcome is Outcome.VIOLATED and v.oracle in (*_GRAVE, "destination", "blocked")
    ]
    return (
        f"{report.run_id:38} {'arrived' if _arrived(report) else 'not there':9} "
        f"{report.sim_time_s:6.1f} s  score {report.metrics['driving_score'] or 0.0:5.1f}  "
        f"{'; '.join(broken)}"
    )


def _arrived(report: RunReport) -> bool:
    return any(v.oracle == "destination" and v.outcome is Outcome.PASSED for v in report.verdicts)


def main() -> None:
    """Runs all routes and prints the table and the sums."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--networks", type=Path, required=True, help="folder of NAME.net.xml")
    parser.add_argument("--routes", type=Path, nargs="+", required=True)
    parser.add_argument("--density", type=float, default=3.0, help="vehicles a km of lane")
    parser.add_argument("--agent", default="idm")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="*", default=[], help="ends of route names")
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    setup = WorkerSetup(shipped_networks=shipped_networks(), imported_networks=options.networks)
    todo = specs(options, NetworkCatalogue(setup.shipped_networks, setup.imported_networks))
    reports: dict[str, RunReport] = {}
    limits = Limits(wall_time_s=900.0)
    with (
        tempfile.TemporaryDirectory() as folder,
        LocalExecutor(
            slots=options.workers, setup=setup, folder=Path(folder), limits=limits
        ) as executor,
    ):
        for spec in todo:
            executor.submit(spec)
        while len(reports) < len(todo):
            reports.update({end.report.run_id: end.report for end in executor.wait()})
    for spec in todo:
        print(_row(reports[spec.run_id]))
    finished = [r for r in reports.values() if r.status is RunStatus.FINISHED]
    broken = Counter(
        f"{v.oracle}{' at fault' if v.at_fault else ''}"
        for r in finished
        for v in r.verdicts
        if v.outcome is Outcome.VIOLATED
    )
    arrived = sum(_arrived(r) for r in finished)
    print(
        f"{len(todo)} routes, {len(finished)} judged, {arrived} arrived; violated: {dict(broken)}"
    )


if __name__ == "__main__":
    main()
