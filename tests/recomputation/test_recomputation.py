"""Verdicts and scores of mixed runs, computed again from the traces with other code.

Nothing here but the runs themselves is the product's: the trace files are read with pyarrow, the
networks with the standard library, and the rules are written anew with NumPy and shapely.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import pytest

from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.spec_running import run_all
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.oracles.verdict import Outcome
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.importers.reading import read_scenarios
from drivora_service.scenario.validation import validate_data
from drivora_service.worker.setup import WorkerSetup
from tests.recomputation import town
from tests.recomputation.comparing import Comparison, Disagreement, Recomputed
from tests.recomputation.comparing_scores import NUPLAN, ScoreComparison
from tests.recomputation.mixed_runs import TOWNS, Document, mixed_documents

RULES = (
    Comparison.lanes,
    Comparison.collisions,
    Comparison.off_road,
    Comparison.speeding,
    Comparison.red_lights,
    Comparison.stop_signs,
    Comparison.completion,
    Comparison.scores,
    ScoreComparison.bench2drive,
    ScoreComparison.nuplan,
)
FEW = ("several_egos-2", "off_the_road-1", "at_signals-7", "with_walkers-0", "at_stop_signs-3")


def _performed(
    documents: Mapping[str, Document], folder: Path, imported: Path | None = None
) -> dict[str, RunReport]:
    """Runs documents on worker processes; all must come to their end."""
    networks = NetworkCatalogue(shipped_networks(), imported)
    specs = [
        RunSpec(
            run_id=name,
            document=canonical_json(validate_data(document, networks, None).scenario),
            trace_path=str(folder / f"{name}.parquet"),
        )
        for name, document in documents.items()
    ]
    setup = WorkerSetup(
        shipped_networks=shipped_networks(), imported_networks=imported, installed_oracles=False
    )
    with LocalExecutor(slots=2, setup=setup, folder=folder / "workers") as executor:
        reports = {report.run_id: report for report in run_all(executor, specs)}
    unfinished = [r for r in reports.values() if r.status is not RunStatus.FINISHED]
    assert not unfinished
    return {name: reports[name] for name in documents}


def _compared(reports: Iterable[RunReport], folder: Path) -> list[ScoreComparison]:
    return [ScoreComparison(report, folder / f"{report.run_id}.parquet") for report in reports]


def _text(disagreements: Iterable[Disagreement]) -> str:
    return "\n".join(
        f"{d.run}, {d.ego}: {d.rule} is {d.stored} as stored, {d.recomputed} recomputed"
        for d in disagreements
    )


def _check(runs: list[ScoreComparison]) -> None:
    wrong = [d for rule in RULES for run in runs for d in rule(run)]
    assert not wrong, f"{len(wrong)} disagreements:\n{_text(wrong)}"


@pytest.fixture(scope="module")
def few(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, RunReport], Path]:
    """Five of the mixed runs, and the folder of their traces."""
    folder = tmp_path_factory.mktemp("few")
    documents = mixed_documents()
    return _performed({name: documents[name] for name in FEW}, folder), folder


def test_five_runs_agree(few: tuple[dict[str, RunReport], Path]) -> None:
    reports, folder = few
    runs = _compared(reports.values(), folder)
    _check(runs)
    egos = [ego for run in runs for ego in run.egos]
    assert len(egos) > len(runs)
    for what in (
        [ego.collisions for ego in egos],
        [ego.speeding for ego in egos],
        [ego.reds for ego in egos],
        [ego.stops for ego in egos],
        [bool(ego.outside.max(initial=0.0) > 0.3) for ego in egos],
        [ego.deviated for ego in egos],
        [ego.completion == 100.0 for ego in egos],
    ):
        assert any(what), what


def _without(report: RunReport, oracle: str) -> RunReport:
    """Returns the report with nothing violated by a rule."""
    verdicts = [
        replace(v, outcome=Outcome.PASSED) if v.oracle == oracle else v for v in report.verdicts
    ]
    return replace(report, verdicts=tuple(verdicts))


def _later(report: RunReport, oracle: str) -> RunReport:
    """Returns the report with violations of a rule one second later."""
    verdicts = [
        replace(v, step=v.step + 20) if v.oracle == oracle and v.step is not None else v
        for v in report.verdicts
    ]
    return replace(report, verdicts=tuple(verdicts))


@pytest.mark.parametrize(
    ("oracle", "rule"),
    [
        ("collision", Comparison.collisions),
        ("off_road", Comparison.off_road),
        ("speeding", Comparison.speeding),
        ("red_light", Comparison.red_lights),
        ("stop_sign", Comparison.stop_signs),
    ],
)
def test_a_wrong_verdict_is_found(
    few: tuple[dict[str, RunReport], Path], oracle: str, rule: object
) -> None:
    reports, folder = few
    for tamper in (_without, _later):
        changed = {name: tamper(report, oracle) for name, report in reports.items()}
        affected = {name for name, report in reports.items() if changed[name] != report}
        found = {
            d.run
            for run in _compared(changed.values(), folder)
            for d in getattr(run, rule.__name__)()  # type: ignore[attr-defined]  # a method by its name
        }
        violated = {
            name
            for name in affected
            if any(
                v.oracle == oracle and v.outcome is Outcome.VIOLATED for v in reports[name].verdicts
            )
        }
        assert violated
        assert violated <= found


@pytest.mark.parametrize(
    ("metric", "rule"),
    [
        ("route_completion", Comparison.completion),
        ("driving_score", Comparison.scores),
        ("driving_score_1_0", Comparison.scores),
        ("driving_score_2_0", Comparison.scores),
        *((metric, ScoreComparison.bench2drive) for metric in ("success", "efficiency", "comfort")),
        ("nuplan_closed_loop", ScoreComparison.nuplan),
        *((f"nuplan_{part}", ScoreComparison.nuplan) for part in NUPLAN),
    ],
)
def test_a_wrong_metric_is_found(
    few: tuple[dict[str, RunReport], Path], metric: str, rule: object
) -> None:
    reports, folder = few
    changed = [
        replace(
            report,
            metrics={
                name: value + 5.0 if value is not None and name.split("[")[0] == metric else value
                for name, value in report.metrics.items()
            },
        )
        for report in reports.values()
    ]
    compared = 0
    for run in _compared(changed, folder):
        found = list(getattr(run, rule.__name__)())  # type: ignore[attr-defined]  # a method by its name
        names = [metric if len(run.egos) == 1 else f"{metric}[{ego.drive.id}]" for ego in run.egos]
        measured = [name for name in names if run.report.metrics[name] is not None]
        assert len({d.ego for d in found}) == len(measured)
        compared += len(measured)
    assert compared >= 3


@pytest.mark.slow(seconds=40)
def test_a_hundred_runs_agree(tmp_path: Path) -> None:
    documents = mixed_documents()
    assert len(documents) == 100
    runs = _compared(_performed(documents, tmp_path).values(), tmp_path)
    _check(runs)
    # Agreement on nothing would prove nothing.
    assert {run.run.head["network"] for run in runs} == set(TOWNS)
    assert sum(run.run.rows for run in runs) > 200_000
    egos = [ego for run in runs for ego in run.egos]
    assert len(egos) >= 110
    roles = Counter(_roles_hit(egos))
    assert min(roles[r] for r in ("ego", "npc_vehicle", "npc_walker", "npc_obstacle")) >= 3
    assert sum(roles.values()) >= 20
    ends = Counter(ego.drive.end for ego in egos)
    assert min(ends[end] for end in ("arrived", "collision", "time_limit")) >= 20
    assert sum(bool(ego.outside.max(initial=0.0) > 0.3) for ego in egos) >= 10
    assert sum(len(ego.speeding) for ego in egos) >= 15
    lines = [(ego, line.step, line.red) for ego in egos for line in ego.lines]
    assert sum(red is True for *_, red in lines) >= 12
    assert sum(red is False for *_, red in lines) >= 12
    assert sum(_is_off_route(ego, step) for ego, step, red in lines if red) >= 2
    stops = [stop.ran for ego in egos for stop in ego.stops]
    assert min(stops.count(True), stops.count(False)) >= 3
    assert sum(ego.deviated for ego in egos) >= 5
    assert sum(ego.completion == 100.0 for ego in egos) >= 20
    assert len({round(score, 3) for ego in egos for score in ego.scores().values()}) >= 100
    assert sum(ego.drive.start_time > 0.0 for ego in egos) >= 5
    values = {metric: _values(runs, metric) for metric in runs[0].report.metrics}
    for metric in ("success", *(f"nuplan_{part}" for part in NUPLAN)):
        least = 1 if metric == "nuplan_making_progress" else 3
        assert sum(value < 1.0 for value in values[metric]) >= least, metric
        assert values[metric].count(1.0) >= 15, metric
    assert values["nuplan_no_at_fault_collision"].count(0.5) >= 3
    for metric in ("efficiency", "comfort", "nuplan_closed_loop", "nuplan_progress_to_free_flow"):
        assert len({round(value, 4) for value in values[metric]}) >= 30, metric
    widths = [high - low for run in runs for low, high in map(run.progress_bounds, run.egos)]
    assert sum(width < 1e-9 for width in widths) >= 80
    assert sum(width < 0.1 for width in widths) >= 110


def _values(runs: Iterable[ScoreComparison], metric: str) -> list[float]:
    """Returns the values of all egos that have one."""
    return [
        value
        for run in runs
        for name, value in run.report.metrics.items()
        if name
        in ([metric] if len(run.egos) == 1 else [f"{metric}[{e.drive.id}]" for e in run.egos])
        and value is not None
    ]


def _roles_hit(egos: Iterable[Recomputed]) -> Iterator[str]:
    for ego in egos:
        roles = {actor["id"]: actor["role"] for actor in ego.run.head["actors"]}
        yield from (roles[other] for other in ego.collisions)


def _is_off_route(ego: Recomputed, step: int) -> bool:
    """Returns whether the ego was beside its route at a step, or soon after."""
    k = step - ego.drive.first
    return bool(ego.progress.beside[k : k + 30].max() > 2.0)


@pytest.mark.slow(seconds=60)
def test_routes_on_towns_of_carla_agree(
    shared_data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Towns on which nothing here was written: with another conversion, signals and long routes."""
    maps = shared_data / "maps"
    for name in ("Town01", "Town02"):
        (tmp_path / "towns" / name).mkdir(parents=True)
        (tmp_path / "towns" / name / f"{name}.net.xml").symlink_to(maps / f"{name}.net.xml")
    monkeypatch.setattr(town, "_TOWNS", tmp_path / "towns")
    documents: dict[str, Document] = {}
    for file in ("leaderboard1_training_town01_04", "leaderboard1_testing_town02_04"):
        content = (shared_data / "routes" / f"{file}.xml").read_bytes()
        for agent in ("idm", "ad-mlp", "plant-lite"):
            for item in read_scenarios(content, name=file, agent=agent)[:5]:
                document = json.loads(document_text(item.document))
                document |= {"background_traffic": {"count": 30}, "seed": 1}
                documents[f"{item.name}-{agent}"] = document
    runs = _compared(_performed(documents, tmp_path, maps).values(), tmp_path)
    _check(runs)
    assert len(runs) == 30
    egos = [ego for run in runs for ego in run.egos]
    lines = [line.red for ego in egos for line in ego.lines]
    assert min(lines.count(True), lines.count(False)) >= 3
    assert sum(len(ego.collisions) for ego in egos) >= 5
    assert sum(ego.completion == 100.0 for ego in egos) >= 10
