"""The CARLA Leaderboard 1.0 routes, imported and driven with background traffic.

Every route must end with a judged report; the table says how long each route is against the
polyline through its waypoints, and what happened on it.

    python -m benchmarks.leaderboard_routes --networks MAPS --routes FILE FILE --density 3 \\
        --table benchmarks/results/leaderboard_routes.md
"""

from __future__ import annotations

import argparse
import math
import tempfile
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.execution.executor import Limits
from drivora_service.execution.local import LocalExecutor
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.routes.routing import match_route, plan_route
from drivora_service.oracles.verdict import Outcome
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.checks.route_checks import route_points
from drivora_service.scenario.entities import BackgroundTrafficDocument
from drivora_service.scenario.importers.reading import read_scenarios
from drivora_service.scenario.validation import validate_document
from drivora_service.worker.setup import WorkerSetup

_GRAVE = ("collision", "red_light", "off_road", "wrong_way")


@dataclass(frozen=True, slots=True, kw_only=True)
class Route:
    """A route to drive.

    Attributes:
        spec: What to run.
        polyline: Metres along the straight lines between its waypoints.
        length: Metres along the lanes.
        left_out: Numbers of the waypoints that the way does not pass.
    """

    spec: RunSpec
    polyline: float
    length: float
    left_out: tuple[int, ...]


def routes(options: argparse.Namespace, catalogue: NetworkCatalogue) -> list[Route]:
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
            points = route_points(valid.scenario.ego_vehicles[0].route)
            found.append(
                Route(
                    spec=RunSpec(run_id=name, document=canonical_json(valid.scenario)),
                    polyline=sum(math.hypot(b.x - a.x, b.y - a.y) for a, b in pairwise(points)),
                    length=plan_route(valid.network, points).length,
                    left_out=match_route(valid.network, points).left_out,
                )
            )
    return found


def table(driven: Sequence[Route], reports: Mapping[str, RunReport]) -> str:
    """Returns the routes as a table in Markdown."""
    lines = [
        "| route | polyline, m | route, m | ratio | left out | arrived | time, s "
        "| collisions at fault | red lights | driving score |",
        "|---|--:|--:|--:|---|---|--:|--:|--:|--:|",
    ]
    for route in driven:
        report = reports[route.spec.run_id]
        broken = [v for v in report.verdicts if v.outcome is Outcome.VIOLATED]
        hits = sum(v.oracle == "collision" and v.at_fault is True for v in broken)
        reds = sum(v.oracle == "red_light" for v in broken)
        left_out = ", ".join(map(str, route.left_out)) or "none"
        score = report.metrics.get("driving_score")
        lines.append(
            f"| {route.spec.run_id} | {route.polyline:.0f} | {route.length:.0f} "
            f"| {route.length / route.polyline:.3f} | {left_out} "
            f"| {'yes' if _has_arrived(report) else 'no'} | {report.sim_time_s:.0f} "
            f"| {hits} | {reds} "
            f"| {'' if score is None else f'{score:.1f}'} |"
        )
    return "\n".join(lines) + "\n"


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
        f"{report.run_id:38} {'arrived' if _has_arrived(report) else 'not there':9} "
        f"{report.sim_time_s:6.1f} s  score {report.metrics['driving_score'] or 0.0:5.1f}  "
        f"{'; '.join(broken)}"
    )


def _has_arrived(report: RunReport) -> bool:
    return any(v.oracle == "destination" and v.outcome is Outcome.PASSED for v in report.verdicts)


def main() -> None:
    """Runs all routes and prints the table with sums."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--networks", type=Path, required=True, help="folder of NAME.net.xml")
    parser.add_argument("--routes", type=Path, nargs="+", required=True)
    parser.add_argument("--density", type=float, default=3.0, help="vehicles a km of lane")
    parser.add_argument("--agent", default="idm")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="*", default=[], help="ends of route names")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--table", type=Path, help="file to write the table to")
    parser.add_argument("--lengths", action="store_true", help="only the lengths, nothing is run")
    options = parser.parse_args()
    setup = WorkerSetup(shipped_networks=shipped_networks(), imported_networks=options.networks)
    driven = routes(options, NetworkCatalogue(setup.shipped_networks, setup.imported_networks))
    if options.lengths:
        for route in driven:
            print(
                f"{route.spec.run_id:26} polyline {route.polyline:6.0f} m  route "
                f"{route.length:6.0f} m  ratio {route.length / route.polyline:.3f}"
            )
        return
    todo = [route.spec for route in driven]
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
    print(table(driven, reports))
    if options.table is not None:
        options.table.write_text(table(driven, reports), encoding="utf-8")
    finished = [r for r in reports.values() if r.status is RunStatus.FINISHED]
    broken = Counter(
        f"{v.oracle}{' at fault' if v.at_fault else ''}"
        for r in finished
        for v in r.verdicts
        if v.outcome is Outcome.VIOLATED
    )
    arrived = sum(_has_arrived(r) for r in finished)
    print(
        f"{len(todo)} routes, {len(finished)} judged, {arrived} arrived; violated: {dict(broken)}"
    )


if __name__ == "__main__":
    main()
