"""The failures to yield on the CARLA Leaderboard 1.0 routes, with facts and pictures to check them.

The routes are driven among background vehicles. For every violation of ``failure_to_yield``, and
for a sample of moments without one in which a vehicle with the right of way braked hard near the
ego, a time line is printed and a picture drawn, from which a reader judges without the oracle.
Routes whose traces are in the folder are judged again without being driven.

    python -m benchmarks.route_yielding --networks MAPS --routes FILE FILE --out FOLDER \\
        --seeds 1 2 3 4 5 6 7 8 9 10
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.projection import project_points
from drivora_service.networks.right_of_way import right_of_way
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Col, Role, Trace
from drivora_service.observations.trace_files.trace_file import read_trace
from drivora_service.oracles.failure_to_yield import FailureToYield
from drivora_service.oracles.verdict import Outcome
from drivora_service.plotting import colors
from drivora_service.plotting.drawn_boxes import draw_box
from drivora_service.plotting.drawn_road import draw_road
from drivora_service.plotting.drawn_signals import draw_signals
from drivora_service.plotting.picture_file import add_map, open_picture
from drivora_service.plotting.picture_view import View
from drivora_service.runs.run_report import RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.entities import BackgroundTrafficDocument
from drivora_service.scenario.importers.reading import read_scenarios
from drivora_service.scenario.validation import validate_document
from drivora_service.worker.performing import perform
from drivora_service.worker.setup import WorkerSetup

_HARD = 3.0
"""m/s² of a braking that a reader looks at, on average over 0.5 s."""

_NEAR = 40.0
"""Metres from the ego within which such a braking is looked at."""

_SIDE_M, _SIDE_IN = 90.0, 3.0
_MOMENTS = (-2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0)
"""Seconds around the moment that a picture shows."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Moment:
    """A moment of a route to look at.

    Attributes:
        route: Name of the route.
        step: Row of the trace.
        other: Row of the other vehicle.
        message: Of the verdict; "" of a moment without one.
    """

    route: str
    step: int
    other: int
    message: str = ""


def drive(options: argparse.Namespace, setup: WorkerSetup) -> Iterator[tuple[str, Path]]:
    """Runs the routes that have no trace yet, and yields the name and trace of each route."""
    catalogue = NetworkCatalogue(setup.shipped_networks, setup.imported_networks)
    for file in options.routes:
        for item in read_scenarios(file.read_bytes(), name=file.stem, agent=options.agent):
            for seed in options.seeds:
                name = f"{file.stem.split('_')[1]}-{item.name}-seed-{seed}".replace("_", "-")
                path = options.out / f"{name}.trace.parquet"
                if not path.exists():
                    traffic = BackgroundTrafficDocument.model_validate({"count": options.count})
                    document = item.document.model_copy(
                        update={"background_traffic": traffic, "seed": seed}
                    )
                    valid = validate_document(document, catalogue, AgentCatalogue().names())
                    text = canonical_json(valid.scenario)
                    spec = RunSpec(run_id=name, document=text, trace_path=str(path))
                    report = perform(spec, setup)
                    if report.status is not RunStatus.FINISHED:
                        sys.exit(f"{name}: {report.status.value}: {report.failure}")
                yield name, path


def violations(name: str, trace: Trace, network: RoadNetwork) -> list[Moment]:
    """Returns the failures to yield of a run, at the time at which the other brakes."""
    rows = {actor.id: actor.row for actor in trace.actors}
    found = []
    for verdict in FailureToYield().judge(RunView(trace, network)):
        if verdict.outcome is Outcome.VIOLATED:
            braked_at = verdict.evidence["braked_at"]
            step = verdict.step or 0
            if braked_at is not None:
                step = int(np.searchsorted(trace.times, braked_at - 1e-9))
            other = rows[verdict.counterpart]
            found.append(Moment(route=name, step=step, other=other, message=verdict.message))
    return found


def hard_brakings(name: str, trace: Trace, network: RoadNetwork) -> Iterator[Moment]:
    """Yields hard brakings near an ego in a junction, of vehicles that go first by the table.

    By the lanes that both drive, without the oracle: which of them brakes for what is not asked.
    """
    table = right_of_way(network).by_lane
    ego = RunView(trace, network).egos[0]
    second = round(1.0 / trace.step_length)
    inside = [table.get(lane) for lane in ego.lanes.tolist()]
    for actor in trace.actors[1:]:
        if actor.role is not Role.BACKGROUND:
            continue
        braking = smoothed_braking(trace, actor.row)
        away = np.hypot(*(trace.states[:, 0, :2] - trace.states[:, actor.row, :2]).T)
        last = -10 * second
        for step in np.flatnonzero((braking >= _HARD) & (away < _NEAR)).tolist():
            rows = slice(step, min(step + 8 * second, len(braking)))
            k = step - ego.first
            own = {move for move in inside[max(k - 4 * second, 0) : max(k + second, 0)] if move}
            if not own or step - last < 5 * second:
                continue
            lanes = set(lanes_of(trace, network, actor.row, rows))
            if any(lanes & set(move.yields_to) for move in own):
                yield Moment(route=name, step=step, other=actor.row)
                last = step


def smoothed_braking(trace: Trace, row: int) -> np.ndarray:
    """Returns (T,) m/s² of braking by displacements, on average over 0.5 s; 0 while absent."""
    count = round(0.5 / trace.step_length)
    speed = np.hypot(trace.states[:, row, Col.VX], trace.states[:, row, Col.VY])
    speed = np.where(trace.present[:, row], speed, np.nan)
    slowing = np.zeros(len(speed))
    slowing[count:] = (speed[:-count] - speed[count:]) / (count * trace.step_length)
    return np.nan_to_num(slowing)


def lanes_of(trace: Trace, network: RoadNetwork, row: int, rows: slice) -> list[int]:
    """Returns the lanes of an actor in rows in which it is present."""
    states = trace.states[rows, row][trace.present[rows, row]]
    xy, yaw = states[:, [Col.X, Col.Y]].copy(), np.ascontiguousarray(states[:, Col.YAW])
    return [int(lane) for lane in project_points(network, xy, yaw).lane]


def time_line(moment: Moment, trace: Trace, network: RoadNetwork) -> str:
    """Returns what ego and other did around a moment, half a second a line."""
    half = round(0.5 / trace.step_length)
    braking = smoothed_braking(trace, moment.other)
    other = trace.actors[moment.other]
    head = "  time    ego  other  braking  apart  ahead of the other        its lane (signal)"
    lines = [f"{moment.route} {trace.times[moment.step]:.2f} s {other.id}: {moment.message}", head]
    last = trace.step_count - 1
    for step in range(max(moment.step - 8 * half, 0), min(moment.step + 16 * half, last), half):
        if not trace.present[step, moment.other]:
            continue
        (lane,) = lanes_of(trace, network, moment.other, slice(step, step + 1))
        speeds = np.hypot(*trace.states[step][:, [Col.VX, Col.VY]].T)
        apart = np.hypot(*(trace.states[step, 0, :2] - trace.states[step, moment.other, :2]))
        lines.append(
            f"{trace.times[step]:6.1f} {speeds[0]:6.1f} {speeds[moment.other]:6.1f} "
            f"{braking[step]:7.1f} {apart:7.1f}  {_ahead(trace, moment.other, step):24} "
            f"{'off' if lane < 0 else network.lanes[lane].id} "
            f"({_signal(trace, network, lane, step)})"
            f"{' <' if abs(step - moment.step) < half else ''}"
        )
    return "\n".join(lines)


def _ahead(trace: Trace, row: int, step: int) -> str:
    """Returns the actor nearest ahead within 30 m on the way that another drives, and how far."""
    present = trace.present[step:, row]
    path = trace.states[step:, row, :2][present]
    arc = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))))
    path = path[arc < 30.0]
    found = []
    for actor in trace.actors:
        if actor.row == row or not trace.present[step, actor.row]:
            continue
        away = np.hypot(*(path - trace.states[step, actor.row, :2]).T)
        nearest = int(np.argmin(away))
        if nearest > 0 and away[nearest] < 2.0:
            found.append((float(arc[nearest]), actor.row))
    if not found:
        return "-"
    distance, ahead = min(found)
    speed = np.hypot(*trace.states[step, ahead, [Col.VX, Col.VY]])
    return f"{trace.actors[ahead].id} {distance:.0f} m {speed:.1f} m/s"


def _signal(trace: Trace, network: RoadNetwork, lane: int, step: int) -> str:
    if lane < 0:
        return "-"
    shown = [
        trace.light_state_names[trace.light_states[step, trace.light_ids.index(c.traffic_light)]][
            c.link_index
        ]
        for c in network.lanes[lane].connections
        if c.traffic_light in trace.light_ids
    ]
    return "".join(shown) or "-"


def draw(moment: Moment, trace: Trace, network: RoadNetwork, target: Path) -> None:
    """Draws the moments around one, side by side: the ego blue, the other red, all with a trail."""
    second = round(1.0 / trace.step_length)
    steps = [moment.step + round(s * second) for s in _MOMENTS]
    steps = [step for step in steps if 0 <= step < trace.step_count]
    across = 4
    down = -(-len(steps) // across)
    height = down * (_SIDE_IN + 0.3)
    with open_picture(target, width_in=across * (_SIDE_IN + 0.1), height_in=height) as figure:
        for place, step in enumerate(steps):
            left = (place % across) * (_SIDE_IN + 0.1)
            bottom = height - (place // across + 1) * (_SIDE_IN + 0.3)
            x, y = trace.states[step, 0, :2].tolist()
            half = 0.5 * _SIDE_M
            view = View(
                min_x=x - half, max_x=x + half, min_y=y - half, max_y=y + half,
                width_in=_SIDE_IN, height_in=_SIDE_IN,
            )  # fmt: skip
            axes = add_map(figure, view, left_in=left, bottom_in=bottom)
            draw_road(axes, network, view)
            draw_signals(axes, trace, network, view, step=step)
            for actor in trace.actors:
                if not trace.present[step, actor.row]:
                    continue
                face = {0: colors.ego_color(0), moment.other: colors.VERDICT}.get(
                    actor.row, colors.ROLES[Role.NPC_VEHICLE]
                )
                back = trace.states[max(step - 2 * second, 0) : step + 1, actor.row]
                back = back[trace.present[max(step - 2 * second, 0) : step + 1, actor.row]]
                axes.plot(back[:, Col.X], back[:, Col.Y], color=face, linewidth=1.2, alpha=0.6)
                draw_box(axes, trace, actor, step, view, face=face, edge="white", z=6.0)
            own, other = np.hypot(*trace.states[step][[0, moment.other]][:, [Col.VX, Col.VY]].T)
            caption = f"{trace.times[step]:.1f} s: ego {own:.1f}, other {other:.1f} m/s"
            axes.set_title(caption, fontsize=8, pad=2)


def main() -> None:
    """Runs the routes, and writes a time line and a picture of each verdict."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--networks", type=Path, required=True, help="folder of NAME.net.xml")
    parser.add_argument("--routes", type=Path, nargs="+", required=True)
    parser.add_argument("--out", type=Path, required=True, help="folder of traces and pictures")
    parser.add_argument("--count", type=int, default=30, help="background vehicles")
    parser.add_argument("--agent", default="idm")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1])
    parser.add_argument("--sample", type=int, default=15, help="moments without a verdict")
    options = parser.parse_args()
    missing = [str(path) for path in (options.networks, *options.routes) if not path.exists()]
    if missing:
        sys.exit(f"not found: {', '.join(missing)}; the routes and towns of CARLA are not shipped")
    options.out.mkdir(parents=True, exist_ok=True)
    setup = WorkerSetup(shipped_networks=shipped_networks(), imported_networks=options.networks)
    networks = NetworkCatalogue(setup.shipped_networks, setup.imported_networks)
    traces = dict(drive(options, setup))
    found: list[Moment] = []
    without: list[Moment] = []
    for name, path in traces.items():
        trace = read_trace(path)
        network = networks.get(trace.network)
        mine = violations(name, trace, network)
        found += mine
        blamed = {moment.other for moment in mine}
        without += [m for m in hard_brakings(name, trace, network) if m.other not in blamed]
    chosen = np.linspace(0, len(without) - 1, min(options.sample, len(without))).round()
    for kind, moments in (
        ("violation", found),
        ("no-verdict", [without[int(place)] for place in chosen]),
    ):
        for number, moment in enumerate(moments, 1):
            trace = read_trace(traces[moment.route])
            network = networks.get(trace.network)
            print(f"\n{kind}-{number:02}: {time_line(moment, trace, network)}", flush=True)
            draw(moment, trace, network, options.out / f"{kind}-{number:02}.png")
    print(
        f"\n{len(traces)} routes; failures to yield: {len(found)}; hard brakings within "
        f"{_NEAR:.0f} m of vehicles with the right of way without one: {len(without)}"
    )


if __name__ == "__main__":
    main()
