"""The throughput of campaigns by method and number of workers, and what their own process needs."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

import yaml

from benchmarks.methods import installed_methods
from benchmarks.scenes import usual_scenes
from benchmarks.suite.measurement import Measurement, Plan, Round, Sample, sample
from benchmarks.suite.result import Better
from benchmarks.throughput import warm_libsumo
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.evaluation.local_evaluator import LOCAL
from drivora_service.campaigns.evaluator import Evaluator, EvaluatorContext
from drivora_service.campaigns.records.campaign_folder import CampaignFolder
from drivora_service.campaigns.records.stored_campaigns import new_campaign, run_stored
from drivora_service.campaigns.search.conducting import Watcher
from drivora_service.campaigns.search.engine import Told
from drivora_service.execution.executor import Limits
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.store.database import open_database
from drivora_service.worker.setup import WorkerSetup

_FIRST, _FIRST_SHORT = 20, 2
"""Evaluations before the clock starts: workers start and perform their first runs."""
SHORT_SIMULATIONS = 6
"""Budget of the short form, which only shows that the campaign of each method runs."""
_EXAMPLES = Path(__file__).parents[2] / "openscenario_schemas" / "examples" / "campaigns"


_CHANGES: dict[str, dict[str, object]] = {
    # Needless lane changes among vehicles that may be absent, judged by an oracle of its own.
    "decictor": {
        "space": {"vehicles": 4, "walkers": 0, "weather": False, "optional": True},
        "oracles": ["non_optimal_decision"],
    },
    # What it adds may be absent.
    "drivefuzz": {
        "space": {
            "vehicles": 5,
            "walkers": 0,
            "obstacles": 2,
            "patches": 3,
            "weather": False,
            "optional": True,
        }
    },
    # It searches for conflicts between several egos, which meet at a junction.
    "doppeltest": {"space": {"egos": 3, "vehicles": 2, "walkers": 0, "weather": False}},
}
"""What the campaigns of some methods have in place of the example's."""


def least_simulations(*, short: bool) -> int:
    """Returns the smallest budget that leaves enough to measure."""
    return 2 * (_FIRST_SHORT if short else _FIRST)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Speed:
    """What a campaign showed after its first evaluations.

    Attributes:
        rate: Evaluations a second.
        own_s: Processor seconds of the campaign's own process an evaluation.
    """

    rate: float
    own_s: float


def campaign_document(method: str, budget: int) -> dict[str, object]:
    """Returns an example's campaign with another method and budget."""
    content: dict[str, object] = yaml.safe_load((_EXAMPLES / "late-braking.yaml").read_text())
    scenario = json.loads((_EXAMPLES / "highway-in-rain.json").read_text())
    if method == "doppeltest":
        scenario = json.loads((_EXAMPLES / "orchard-lane.json").read_text())
    return {
        **content,
        "name": f"throughput of {method}",
        "scenario": scenario,
        "tester": {"name": method},
        "budget": {"simulations": budget},
        **_CHANGES.get(method, {}),
    }


def _campaign(
    document: dict[str, object], workers: int, first: int, catalogues: Catalogues, folder: Path
) -> _Speed:
    """Runs a campaign as a command does; returns its speed after its first evaluations."""
    folder.mkdir()
    marks: list[tuple[float, float]] = []

    def mark_time(_told: Told) -> None:
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
            watcher=Watcher(on_told=mark_time),
        )
    finally:
        database.close()
    (own, begun), (own_last, last) = marks[first], marks[-1]
    count = len(marks) - 1 - first
    return _Speed(rate=count / (last - begun), own_s=(own_last - own) / count)


@contextmanager
def _open(plan: Plan) -> Iterator[Round]:
    catalogues = Catalogues(NetworkCatalogue(shipped_networks()))
    methods, left_out = installed_methods()
    plan.remarks.extend(f"{one}." for one in left_out)
    first = _FIRST_SHORT if plan.short else _FIRST
    # An even number, half of it for each of two processes.
    replayed = usual_scenes(max(plan.simulations // 8, 4) * 2, seed=1)
    numbers = iter(range(1_000_000))
    with ExitStack() as stack:
        bare = {k: stack.enter_context(warm_libsumo(k)) for k in (1, 2)}

        def once() -> Iterator[Sample]:
            for method in methods:
                # The short form shows of one method what two workers give.
                compared = (1, 2) if not plan.short or method == methods[0] else (2,)
                document = campaign_document(method, plan.simulations)
                speeds = {
                    workers: _campaign(
                        document, workers, first, catalogues, plan.folder / str(next(numbers))
                    )
                    for workers in compared
                }
                case, higher = f"{method}, {plan.simulations} simulations", Better.HIGHER
                for workers, speed in speeds.items():
                    yield sample(case, f"K = {workers}", speed.rate, "simulations/s", higher)
                if len(speeds) > 1:
                    bare_gain = bare[1](replayed) / bare[2](replayed)
                    gain = speeds[2].rate / speeds[1].rate
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
    about="Campaigns of every method on `highway-in-rain`, one after the other with K = 1 and "
    "K = 2 workers, from the 21st simulation on (short form: from the third on, and all but "
    "Random with K = 2 alone, which shows that they run, no more), without the confirmation of "
    "failures. "
    "The own process of a campaign is everything that is no worker: engine, method, store, "
    "supervision of workers; its processor time. Beside them what one and two bare libsumo "
    "processes replay. DoppelTest has three egos a simulation, on `orchard-lane`; DeepCollision "
    "needs its extra, and is left out without it.",
    open=_open,
)
