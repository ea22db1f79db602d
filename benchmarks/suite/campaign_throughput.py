"""The throughput of campaigns by method and number of workers, and what their own process needs."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

import yaml

from benchmarks.scenes import usual_scenes
from benchmarks.suite.measurement import Measurement, Plan, Round, Sample, sample
from benchmarks.suite.result import Better
from benchmarks.throughput import warm_libsumo
from drivora_service.campaigns.catalogues import Catalogues
from drivora_service.campaigns.conducting import Watcher
from drivora_service.campaigns.engine import Told
from drivora_service.campaigns.evaluator import Evaluator, EvaluatorContext
from drivora_service.campaigns.folder import CampaignFolder
from drivora_service.campaigns.local_evaluator import LOCAL
from drivora_service.campaigns.reading import read_campaign
from drivora_service.campaigns.stored import new_campaign, run_stored
from drivora_service.execution.executor import Limits
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.store.database import open_database
from drivora_service.worker.setup import WorkerSetup

_METHODS = ("random", "avfuzzer", "behavexplor", "doppeltest", "samota")
_SHORT_METHODS = ("random",)
_FIRST = 20
"""Evaluations before the clock starts: workers start and perform their first runs."""
LEAST_SIMULATIONS = 2 * _FIRST
"""Smallest budget that leaves enough to measure."""
_EXAMPLES = Path(__file__).parents[2] / "openscenario_schemas" / "examples" / "campaigns"


@dataclass(frozen=True, slots=True, kw_only=True)
class _Speed:
    """What a campaign showed from its 21st evaluation on.

    Attributes:
        rate: Evaluations a second.
        own_s: Processor seconds of the campaign's own process an evaluation.
    """

    rate: float
    own_s: float


def _document(method: str, budget: int) -> dict[str, object]:
    """Returns an example's campaign with another method and budget."""
    content: dict[str, object] = yaml.safe_load((_EXAMPLES / "late-braking.yaml").read_text())
    scenario = json.loads((_EXAMPLES / "highway-in-rain.json").read_text())
    changed: dict[str, object] = {
        **content,
        "name": f"throughput of {method}",
        "scenario": scenario,
        "tester": {"name": method},
        "budget": {"simulations": budget},
    }
    if method == "doppeltest":
        # It searches for conflicts between several egos, which meet at a junction.
        changed["space"] = {"egos": 3, "vehicles": 2, "walkers": 0, "weather": False}
        changed["scenario"] = json.loads((_EXAMPLES / "orchard-lane.json").read_text())
    return changed


def _campaign(
    document: dict[str, object], workers: int, catalogues: Catalogues, folder: Path
) -> _Speed:
    """Runs a campaign as a command does; returns its speed."""
    folder.mkdir()
    marks: list[tuple[float, float]] = []

    def told(_told: Told) -> None:
        marks.append((time.process_time(), time.monotonic()))

    @contextmanager
    def evaluator(_workers: int | None) -> Iterator[Evaluator]:
        context = EvaluatorContext(
            workers=workers,
            setup=WorkerSetup(shipped_networks=shipped_networks()),
            limits=Limits(),
            folder=folder / "workers",
        )
        context.folder.mkdir()
        with closing(LOCAL.create(context)) as created:
            yield created

    database = open_database(f"sqlite:///{folder / 'drivora.sqlite3'}")
    try:
        with database.write() as transaction:
            campaign = transaction.campaigns.create(
                new_campaign(read_campaign(document, catalogues))
            )
        run_stored(
            database,
            campaign.id,
            CampaignFolder(folder / "campaigns", campaign.id),
            catalogues=catalogues,
            evaluator=evaluator,
            watcher=Watcher(on_told=told),
        )
    finally:
        database.close()
    (own, begun), (own_last, last) = marks[_FIRST], marks[-1]
    count = len(marks) - 1 - _FIRST
    return _Speed(rate=count / (last - begun), own_s=(own_last - own) / count)


@contextmanager
def _open(plan: Plan) -> Iterator[Round]:
    catalogues = Catalogues(NetworkCatalogue(shipped_networks()))
    # An even number, half of it for each of two processes.
    replayed = usual_scenes(max(plan.simulations // 8, 4) * 2, seed=1)
    numbers = iter(range(1_000_000))
    with ExitStack() as stack:
        bare = {k: stack.enter_context(warm_libsumo(k)) for k in (1, 2)}

        def once() -> Iterator[Sample]:
            for method in _SHORT_METHODS if plan.short else _METHODS:
                document = _document(method, plan.simulations)
                speeds = {
                    workers: _campaign(
                        document, workers, catalogues, plan.folder / str(next(numbers))
                    )
                    for workers in (1, 2)
                }
                bare_gain = bare[1](replayed) / bare[2](replayed)
                gain = speeds[2].rate / speeds[1].rate
                case, higher = f"{method}, {plan.simulations} simulations", Better.HIGHER
                yield sample(case, "K = 1", speeds[1].rate, "simulations/s", higher)
                yield sample(case, "K = 2", speeds[2].rate, "simulations/s", higher)
                yield sample(case, "K = 2 / K = 1", gain, "", higher)
                yield sample(case, "bare libsumo, 2 / 1", bare_gain, "", Better.NEITHER)
                yield sample(case, "of what libsumo gains", gain / bare_gain, "", higher)
                for workers, speed in speeds.items():
                    name = f"own process, K = {workers}"
                    yield sample(case, name, 1e3 * speed.own_s, "ms/simulation")

        yield once


CAMPAIGNS = Measurement(
    name="campaigns",
    title="Throughput of campaigns",
    about="Campaigns on `highway-in-rain` (short form: Random alone), one after the other with "
    "K = 1 and K = 2 workers, from the 21st simulation on, without the confirmation of failures. "
    "The own process of a campaign is everything that is no worker: engine, method, store, "
    "supervision of workers; its processor time. Beside them what one and two bare libsumo "
    "processes replay. DoppelTest has three egos a simulation, on `orchard-lane`.",
    open=_open,
)
