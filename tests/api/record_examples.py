"""Records the answers that the API's documentation shows: ``make api-examples``.

Usage: ``python -m tests.api.record_examples``. A real service is asked for everything. What differs
from one recording to the next, ids, times, durations and the folder of the service, is replaced by
values that stay; long lists are cut.
"""

from __future__ import annotations

import json
import os
import re
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any, Protocol
from unittest import mock

import httpx
import yaml

from drivora_service.api.documentation import recorded_examples
from drivora_service.api_paths import PREFIX
from drivora_service.cli.application.service_process import run_service
from drivora_service.oracles.oracles_version import ORACLES

FOLDER = Path(recorded_examples.__file__).with_name("recorded")
_CAMPAIGN_FILE = (
    Path(__file__).parents[2] / "openscenario_schemas/examples/campaigns/late-braking.yaml"
)
"""A campaign that finds failures."""

_ID = re.compile(r"(?<![0-9a-f])[0-9a-f]{24}(?![0-9a-f])")
_DATA_FOLDER = "/var/lib/drivora"
_ORACLES = "5c1f0be92a7d"
_PAGE_TOKEN = "WyI1ZmVjZWI2NmZmYzgiLCAxXQ"
_TIMES = {
    "created_at": "2026-03-02T09:30:00Z",
    "claimed_at": "2026-03-02T09:30:01Z",
    "started_at": "2026-03-02T09:30:01Z",
    "ended_at": "2026-03-02T09:30:21Z",
    "updated_at": "2026-03-02T09:30:21Z",
    "told_at": "2026-03-02T09:30:04Z",
    "since": "2026-03-02T09:30:01Z",
    "found_at": "2026-03-02T09:30:04Z",
    "first_seen": "2026-03-02T09:30:04Z",
    "last_seen": "2026-03-02T09:30:19Z",
    "status_at": "2026-03-02T09:30:40Z",
    "changed_at": "2026-03-02T09:30:40Z",
    "at": "2026-03-02T09:30:40Z",
}
_REVISION, _EPOCH = 4711, "5f0c2b7a91de"
_DURATIONS = {
    "wall_time_s": 0.11,
    "step_cost_us": 58.0,
    "agent_cost_us": 9.0,
    "search_s": 0.0012,
    "prepare_s": 0.0041,
    "rate": 2.0,
    "active_s": 20.0,
    "simulation_s": 4.4,
    "own_s": 0.2,
    "own_share": 0.2 / 4.4,
    "first_failure_s": 0.2,
}
_UNSTEADY_METRICS = {
    "drivora_traces_free_bytes": 5e10,
    "drivora_database_bytes": 1e6,
    "drivora_slot_memory_bytes": 2e8,
    "drivora_queue_oldest_age_seconds": 0.0,
}
_MOST_ITEMS, _MOST_NUMBERS = 3, 8
"""Of a list: objects or lists, and values."""
_LINES = 20
"""Of a picture, which has thousands."""
_ALL = 1000
_PATIENCE_S = 300.0

_CONTAINER = {
    "id": "container",
    "model": "static.prop.container",
    "location": {"x": 3.4, "y": 50.0, "yaw": 91.51},
}
_CRASH: dict[str, Any] = {
    **recorded_examples.SCENARIO,
    "ego_vehicles": [
        {**recorded_examples.SCENARIO["ego_vehicles"][0], "agent": {"name": "scripted"}}
    ],
    "npc_obstacles": [_CONTAINER],
}
_CROWDED_CRASH: dict[str, Any] = {
    **_CRASH,
    "npc_walkers": [
        {
            "id": "walker",
            "model": "walker.pedestrian.0001",
            "route": [{"x": -2.0, "y": 62.0}, {"x": -2.0, "y": 82.5, "speed": 1.25}],
        }
    ],
    "weather": {"precipitation": 40.0, "wetness": 55.5},
}
"""The same crash, with things that do not matter for it."""
LONG: dict[str, Any] = {
    **recorded_examples.SCENARIO,
    "ego_vehicles": [
        {**ego, "agent": {"name": "pdm-closed"}}
        for ego in recorded_examples.SCENARIO["ego_vehicles"]
    ],
    "npc_obstacles": [_CONTAINER],
    "background_traffic": {"count": 150},
    "step_length": 0.01,
    "max_sim_time": 3600.0,
    "stuck_after": 3600.0,
}
"""Keeps a worker busy for several seconds, in which the queue is looked at."""


class Serve(Protocol):
    """Starts a service, yields its address, and ends it."""

    def __call__(self, data_dir: Path, *, workers: int) -> AbstractContextManager[str]: ...


def main() -> None:
    """Writes all files anew, and names those that changed."""
    recorded = record_examples(run_service)
    for path in FOLDER.iterdir():
        if path.name not in recorded:
            path.unlink()
            print(f"{path.name}: removed")
    for name, text in recorded.items():
        path = FOLDER / name
        before = path.read_text() if path.is_file() else ""
        path.write_text(text)
        print(f"{name}: {'as it was' if text == before else 'written anew'}", flush=True)


def record_examples(serve: Serve) -> dict[str, str]:
    """Returns the texts of the files by their names.

    Args:
        serve: Starts a service on a data folder, with one worker.
    """
    with (
        tempfile.TemporaryDirectory() as folder,
        mock.patch.dict(os.environ, DRIVORA_CAMPAIGNS_AT_ONCE="1"),
    ):
        data = Path(folder) / "data"
        with (
            serve(data, workers=1) as url,
            httpx.Client(base_url=url, timeout=60.0) as client,
        ):
            recording = _Recording(client, data)
            recording.catalogues()
            recording.queue()
            recording.campaigns()
            recording.studies()
            recording.minimizations()
            recording.state()
        return recording.files


class _Recording:
    """Asks a service for everything, and keeps the answers.

    Attributes:
        files: Texts by the names of their files.
    """

    def __init__(self, client: httpx.Client, data: Path) -> None:
        self._client, self._data = client, data
        self._ids: dict[str, str] = {}
        self.files: dict[str, str] = {}

    def catalogues(self) -> None:
        """Records what there is to choose from."""
        self._wait(
            "/workers", lambda found: all(slot["state"] == "idle" for slot in found["slots"])
        )
        workers = self._get("/workers")
        for slot in workers["slots"]:
            slot |= {"host": "workstation", "pid": 4711, "memory_bytes": 213_110_784}
        self._keep(recorded_examples.WORKERS, workers)
        self._keep(recorded_examples.SESSION, self._get("/session"))
        self._keep(recorded_examples.HEALTH, self._get("/healthz"))
        self._keep(recorded_examples.READINESS, self._get("/readyz"), most=_ALL)
        self._keep(recorded_examples.NETWORKS, self._get("/networks"), most=_ALL)
        self._keep(recorded_examples.NETWORK, self._get("/networks/tee-town"))
        geometry = self._get("/networks/tee-town/geometry")
        for key in ("junctions", "junction_types"):
            geometry[key] = dict(list(geometry[key].items())[:1])
        # The lanes of junctions come first.
        geometry["lanes"].sort(key=lambda lane: lane["internal"])
        self._keep(recorded_examples.GEOMETRY, geometry)
        self._keep(recorded_examples.AGENTS, _named(self._get("/agents"), "idm", "idm-mobil"))
        self._keep(recorded_examples.TESTERS, _named(self._get("/testers"), "avfuzzer"))
        self._keep(recorded_examples.MEASURES, self._get("/metrics:describe"))
        self._keep(recorded_examples.ORACLES, self._get("/oracles"))
        self._keep(recorded_examples.MODELS, self._get("/models"))
        self._keep(
            recorded_examples.EXAMPLE_SCENARIOS,
            _named(self._get("/scenarios:examples"), "church lane"),
            most=_ALL,
        )
        self._keep(recorded_examples.SPACE_PRESETS, self._get("/campaigns:presets"), most=_ALL)

    def queue(self) -> None:
        """Records jobs, batches and runs, while they wait and when they have ended."""
        validation = self._post("/scenarios:validate", recorded_examples.SCENARIO)
        self._keep(recorded_examples.VALIDATION, validation)
        self._keep(
            recorded_examples.INSPECTION,
            self._post("/scenarios:inspect", recorded_examples.SCENARIO),
        )
        with self._busy_worker():
            job = self._post("/jobs?label=crossing-17", _CRASH)
            self._keep(recorded_examples.QUEUED_JOB, job)
            unknown = {**recorded_examples.SCENARIO, "map_region": {"town": "Town99"}}
            labelled = {"label": "crossing-17", "scenario": recorded_examples.SCENARIO}
            submission = self._post("/batches?name=nightly", [labelled, unknown])
            self._keep(recorded_examples.SUBMISSION, submission)
            batch = f"/batches/{submission['batch']['id']}"
            self._keep(recorded_examples.PAUSED_BATCH, self._post(f"{batch}:pause"))
            self._keep(recorded_examples.RESUMED_BATCH, self._post(f"{batch}:resume"))
            self._keep(recorded_examples.CANCELLED_BATCH, self._post(f"{batch}:cancel"))
            other = self._post("/jobs?label=crossing-18", recorded_examples.SCENARIO)
            self._keep(recorded_examples.CANCELLED_JOB, self._post(f"/jobs/{other['id']}:cancel"))
        posted = self._post("/batches?name=nightly", [recorded_examples.SCENARIO])
        batch = f"/batches/{posted['batch']['id']}"
        self._keep(recorded_examples.BATCH, self._wait(batch, lambda found: found["done"]))
        self._keep(recorded_examples.BATCHES, self._get("/batches?limit=1"))
        self._keep(recorded_examples.FOUND_ID, self._get("/ids?kind=batch&wanted=latest"))
        self._keep(recorded_examples.EVENTS, self._events(f"of={job['id']}&after=0", 2))
        self._keep(recorded_examples.JOB, self._get(f"/jobs/{job['id']}"))
        self._keep(recorded_examples.JOBS, self._get("/jobs?limit=1&status=cancelled"))
        run = f"/runs/{job['id']}"
        self._keep(recorded_examples.RUN, self._get(run))
        self._keep(recorded_examples.RUNS, self._get("/runs?limit=1&status=finished"))
        self._keep(
            recorded_examples.RUN_COUNTS,
            self._get(f"/runs:counts?batch={batch.rpartition('/')[2]}"),
        )
        wanted = "column=run_id&column=oracle&column=outcome&column=at_fault&column=message"
        wanted += "&violated=true"
        self._keep(recorded_examples.RESULT_TABLE, self._table(f"/tables/verdicts?{wanted}", 4))
        picture = self._client.get(f"{PREFIX}{run}/picture").text.splitlines(keepends=True)
        self._keep(recorded_examples.PICTURE, "".join(picture[:_LINES]))
        self._keep(recorded_examples.RUN_SCENARIO, self._get(f"{run}/scenario"))
        self._keep(recorded_examples.FRAME, self._lines(f"{run}/observations", 1))
        self._keep(recorded_examples.PERCEPTION, self._get(f"{run}/perception"))
        self._keep(recorded_examples.SERIES, self._get(f"{run}/series"))
        self._keep(recorded_examples.TIMELINE, self._get(f"{run}/timeline"))

    def campaigns(self) -> None:
        """Records a campaign, what may befall one that waits, and a comparison of methods."""
        self._keep(
            recorded_examples.CAMPAIGN_VALIDATION,
            self._post("/campaigns:validate", recorded_examples.CAMPAIGN),
        )
        posted = self._post("/campaigns", _searching(name="braking too late", simulations=40))
        self._keep(recorded_examples.QUEUED_CAMPAIGN, posted)
        other = f"/campaigns/{self._post('/campaigns', recorded_examples.CAMPAIGN)['id']}"
        self._keep(recorded_examples.PAUSED_CAMPAIGN, self._post(f"{other}:pause"))
        self._keep(recorded_examples.RESUMED_CAMPAIGN, self._post(f"{other}:resume"))
        self._keep(recorded_examples.CANCELLED_CAMPAIGN, self._post(f"{other}:cancel"))
        one = f"/campaigns/{posted['id']}"
        self._keep(recorded_examples.FINISHED_CAMPAIGN, self._finished(one))
        self._keep(recorded_examples.CAMPAIGNS, self._get("/campaigns?limit=1&state=finished"))
        self._keep(recorded_examples.FIGURES, self._get(f"{one}/figures"))
        self._keep(recorded_examples.COVERAGE, self._get(f"{one}/coverage"))
        self._keep(recorded_examples.DISCOVERIES, self._get(f"{one}/discoveries?points=6&kinds=2"))
        wanted = "column=evaluation&column=kind&column=at_fault&column=time_s&column=sentence"
        table = self._table(f"{one}/tables/failures?{wanted}", 3)
        self._keep(recorded_examples.CAMPAIGN_TABLE, table)
        self._keep(recorded_examples.FAILURES, self._get(f"{one}/failures?limit=1"))
        failing = self._get(f"{one}/evaluations?violating=true&order=-number&limit=1")
        self._keep(recorded_examples.EVALUATIONS, failing)
        evaluation = f"{one}/evaluations/{failing['items'][0]['number']}"
        self._keep(recorded_examples.EVALUATION, self._get(evaluation))
        self._keep(recorded_examples.EVALUATION_SCENARIO, self._get(f"{evaluation}/scenario"))
        self._keep(recorded_examples.EVALUATION_FRAME, self._lines(f"{evaluation}/observations", 1))
        wanted = "oracle=collision&accountability=avoidable"
        found = self._get(f"/failures?{wanted}&limit=1")
        self._keep(recorded_examples.FOUND_FAILURES, found)
        self._keep(recorded_examples.FOUND_COUNTS, self._get("/failures:counts"))
        self._keep(
            recorded_examples.FOUND_FAILURE, self._get(f"/failures/{found['items'][0]['id']}")
        )
        groups = self._get("/failures/groups?limit=2")
        self._keep(recorded_examples.FAILURE_GROUPS, groups)
        group = f"/failures/groups/{groups['items'][0]['id']}"
        decision = {"status": "known", "note": "Issue 12.", "assignee": "Ada", "by": "Ada"}
        self._keep(recorded_examples.FAILURE_GROUP, self._post(f"{group}:decide", decision))
        self._keep(recorded_examples.GROUP_CHANGES, self._get(f"{group}/changes"))
        self._keep(
            recorded_examples.SUITE_RUN,
            self._post("/suite-runs", recorded_examples.SUITE_RUN_REQUEST),
        )
        self._keep(recorded_examples.SUITE_RUNS, self._get("/suite-runs?suite=smoke"))
        self._keep(recorded_examples.SUITES, self._get("/suites"))
        self._keep(recorded_examples.SUITE_HISTORY, self._get("/suites:history?suite=smoke&runs=5"))
        studied = [
            self._post(
                "/campaigns",
                _searching(name=f"study-{tester}-{seed}", tester=tester, seed=seed, simulations=20),
            )["id"]
            for tester in ("random", "avfuzzer")
            for seed in (20, 23)
        ]
        for campaign in studied:
            self._finished(f"/campaigns/{campaign}")
        wanted = "campaign=study-*&measure=at_fault&measure=kinds"
        self._keep(recorded_examples.COMPARISON, self._get(f"/campaigns:compare?{wanted}"))

    def studies(self) -> None:
        """Records a study, what may befall one that waits, its comparison and a table of it."""
        campaign = _searching(name="", simulations=8)
        study: dict[str, Any] = {
            "name": "braking too late",
            "scenarios": [{"label": "late braking", "document": campaign["scenario"]}],
            "agents": [campaign["agent"]],
            "methods": [{"name": "random"}, {"name": "avfuzzer"}],
            "repetitions": 2,
            "seed": 4,
            "space": campaign["space"],
            "oracles": campaign["oracles"],
            "budget": campaign["budget"],
        }
        self._keep(recorded_examples.STUDY_VALIDATION, self._post("/studies:validate", study))
        # One campaign runs at a time: the study waits for this one.
        first = self._post("/campaigns", _searching(name="first", simulations=100_000))
        other = self._post("/studies", study)
        cancelled = self._post(f"/studies/{other['id']}:cancel")
        posted = self._post("/studies", study)
        self._keep(recorded_examples.QUEUED_STUDY, posted)
        one = f"/studies/{posted['id']}"
        self._keep(recorded_examples.PAUSED_STUDY, self._post(f"{one}:pause"))
        self._keep(recorded_examples.RESUMED_STUDY, self._post(f"{one}:resume"))
        self._post(f"/campaigns/{first['id']}:cancel")
        self._wait(one, lambda found: found["state"] not in ("queued", "running"))
        self._keep(recorded_examples.FINISHED_STUDY, self._get(one))
        self._keep(recorded_examples.STUDIES, self._get("/studies?limit=1"))
        comparison = self._get(f"{one}/comparison?measure=failing")
        self._keep(recorded_examples.STUDY_COMPARISON, comparison)
        self._keep(recorded_examples.STUDY_BANDS, self._get(f"{one}/bands?method=random&points=5"))
        table = self._client.get(f"{PREFIX}{one}/tables/campaigns")
        table.raise_for_status()
        lines = table.text.splitlines(keepends=True)[:2]
        self._keep(recorded_examples.STUDY_TABLE, re.sub(r"[0-9.]+\n$", "20.0\n", "".join(lines)))
        self._keep(recorded_examples.CANCELLED_STUDY, cancelled)

    def minimizations(self) -> None:
        """Records a minimisation, while it waits and when it has ended, and a cancelled one."""
        run = self._finished_run(_CROWDED_CRASH)
        with self._busy_worker():
            queued = self._post(f"/runs/{run}:minimize", {"oracle": "collision", "budget": 200})
            self._keep(recorded_examples.QUEUED_MINIMIZATION, queued)
            other = self._post(f"/runs/{run}:minimize")
            self._wait(f"/minimizations/{other['id']}", lambda found: bool(found["started_at"]))
            cancelled = self._post(f"/minimizations/{other['id']}:cancel")
            self._keep(recorded_examples.CANCELLED_MINIMIZATION, cancelled)
        one = f"/minimizations/{queued['id']}"
        self._wait(one, lambda found: found["state"] not in ("queued", "running"))
        self._keep(recorded_examples.FINISHED_MINIMIZATION, self._get(one), most=_ALL)
        self._keep(recorded_examples.MINIMIZATIONS, self._get("/minimizations?limit=1"))

    def _finished_run(self, scenario: Mapping[str, Any]) -> str:
        job: str = self._post("/jobs?label=crossing-19", scenario)["id"]
        self._wait(f"/jobs/{job}", lambda found: found["status"] == "finished")
        return job

    def state(self) -> None:
        """Records the figures of the service, and what it says when its traces have gone."""
        self._keep(recorded_examples.METRICS, _steady_metrics(self._client.get("/metrics").text))
        # After all else, so that the ids of the other examples stay.
        self._keep(recorded_examples.BATCH_COMPARISON, self._two_batches())
        traces = self._data / "traces"
        traces.rename(self._data / "gone")
        traces.touch()
        until = time.monotonic() + _PATIENCE_S
        while (answer := self._client.get("/readyz")).is_success:
            assert time.monotonic() < until
            time.sleep(0.2)
        self._keep(recorded_examples.NOT_READY, answer.json(), most=_ALL)

    def _two_batches(self) -> Any:
        """Returns the comparison of two agents on the same scenarios."""
        scenarios = {"crossing-17": _CRASH, "crossing-18": recorded_examples.SCENARIO}
        items = [{"label": label, "scenario": one} for label, one in scenarios.items()]
        batches = []
        for name, agent in (("nightly", "scripted"), ("candidate", "idm")):
            posted = self._post(f"/batches?name={name}&agent={agent}", items)
            batches.append(posted["batch"]["id"])
            self._wait(f"/batches/{batches[-1]}", lambda found: found["done"])
        return self._get(f"/batches:compare?a={batches[0]}&b={batches[1]}&metric=driving_score")

    @contextmanager
    def _busy_worker(self) -> Iterator[None]:
        job = self._post("/jobs", LONG)["id"]
        self._wait(f"/jobs/{job}", lambda found: found["status"] == "running")
        yield
        found = self._get(f"/jobs/{job}")
        assert found["status"] == "running", found
        self._post(f"/jobs/{job}:cancel")

    def _finished(self, campaign: str) -> Any:
        found = self._wait(campaign, lambda found: found["state"] not in ("queued", "running"))
        assert found["state"] == "finished", found
        return found

    def _wait(self, path: str, until: Callable[[Any], bool]) -> Any:
        deadline = time.monotonic() + _PATIENCE_S
        while not until(found := self._get(path)):
            assert time.monotonic() < deadline, found
            time.sleep(0.1)
        return found

    def _get(self, path: str) -> Any:
        answer = self._client.get(f"{PREFIX}{path}")
        answer.raise_for_status()
        return answer.json()

    def _post(self, path: str, body: object = None) -> Any:
        answer = self._client.post(f"{PREFIX}{path}", json=body)
        assert answer.is_success, answer.text
        return answer.json()

    def _lines(self, path: str, count: int) -> str:
        answer = self._client.get(f"{PREFIX}{path}", headers={"Accept": "application/x-ndjson"})
        answer.raise_for_status()
        return "".join(answer.text.splitlines(keepends=True)[:count])

    def _events(self, query: str, count: int) -> str:
        """Returns the first events of a stream, with numbers that stay."""
        events: list[str] = []
        lines: list[str] = []
        with self._client.stream("GET", f"{PREFIX}/events?{query}") as answer:
            for line in answer.iter_lines():
                lines.append(line)
                if not line:
                    events.append("\n".join(lines) + "\n")
                    lines.clear()
                if len(events) == count:
                    break
        text = re.sub(r'(?<="revision":)\d+', str(_REVISION), "".join(events))
        return re.sub(r"^id: .*$", f"id: {_EPOCH}.{_REVISION}", text, flags=re.MULTILINE)

    def _table(self, path: str, lines: int) -> str:
        answer = self._client.get(f"{PREFIX}{path}", headers={"Accept": "text/csv"})
        answer.raise_for_status()
        return "".join(answer.text.splitlines(keepends=True)[:lines])

    def _keep(self, example: str, answer: object, *, most: int = _MOST_ITEMS) -> None:
        name = example.removeprefix(recorded_examples.RECORDED)
        assert name not in self.files
        if isinstance(answer, str):
            self.files[name] = self._steady_text(answer)
        else:
            steady = _cut(self._steady(answer), most)
            self.files[name] = json.dumps(steady, indent=1, ensure_ascii=False) + "\n"

    def _steady(self, value: Any, key: str = "") -> Any:
        """Returns an answer without what differs from one recording to the next."""
        if isinstance(value, dict):
            costs = key == "agent_cost_us"
            return {
                self._steady_text(name): self._steady(inner, key if costs else name)
                for name, inner in value.items()
            }
        if isinstance(value, list):
            return [self._steady(inner, key) for inner in value]
        if isinstance(value, str):
            if key == "next_page_token":
                return value and _PAGE_TOKEN
            if key == ORACLES:
                return _ORACLES
            return _TIMES.get(key, self._steady_text(value))
        if key == "revision":
            return _REVISION
        if isinstance(value, float) and value:
            return _DURATIONS.get(key, value)
        return value

    def _steady_text(self, text: str) -> str:
        text = text.replace(str(self._data), _DATA_FOLDER)
        return _ID.sub(
            lambda found: self._ids.setdefault(found[0], f"0193a5b0c4d2{len(self._ids) + 1:012x}"),
            text,
        )


def _searching(
    *, name: str, simulations: int, tester: str = "avfuzzer", seed: int = 20
) -> dict[str, Any]:
    content = yaml.safe_load(_CAMPAIGN_FILE.read_text())
    scenario = json.loads(_CAMPAIGN_FILE.with_name(content["scenario"]["file"]).read_text())
    return {
        **content,
        "name": name,
        "tester": {"name": tester},
        "scenario": scenario,
        "budget": {"simulations": simulations},
        "seed": seed,
    }


def _named(answer: Mapping[str, Any], *names: str) -> dict[str, Any]:
    return {**answer, "items": [item for item in answer["items"] if item["name"] in names]}


def _cut(value: Any, most: int) -> Any:
    """Returns an answer whose lists have at most so many items, or some more plain values."""
    if isinstance(value, dict):
        return {key: _cut(inner, most) for key, inner in value.items()}
    if not isinstance(value, list):
        return value
    is_plain = not any(isinstance(inner, dict | list) for inner in value)
    return [_cut(inner, most) for inner in value[: _MOST_NUMBERS if is_plain else most]]


def _steady_metrics(text: str) -> str:
    lines = []
    for line in text.splitlines():
        name = line.split()[2] if line.startswith("#") else re.split(r"[ {]", line)[0]
        if name.startswith("drivora_request_seconds"):
            continue
        if name in _UNSTEADY_METRICS and not line.startswith("#"):
            line = f"{line.rpartition(' ')[0]} {_UNSTEADY_METRICS[name]}"
        lines.append(line)
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
