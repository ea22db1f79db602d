"""What every client does, with a real service and with the application in this process."""

from __future__ import annotations

import copy
import csv
import io
import json
import time
import uuid
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from drivora_service.api.documentation.recorded_examples import CAMPAIGN, SCENARIO
from drivora_service.api.schemas.batches import Batch, ItemResult
from drivora_service.api.schemas.campaigns import Campaign
from drivora_service.api.schemas.runs import Run
from drivora_service.client import Client, ObservationForm, TraceRows
from drivora_service.errors import (
    InvalidDocument,
    NetworkError,
    NotFound,
    RequestConflict,
    ServiceError,
    StoreError,
)
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.networks.importing.source_formats import SourceFormat
from drivora_service.oracles.verdicts.failure_definition import Counted
from drivora_service.runs.run_report import RunStatus
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaigns.campaign_records import (
    CampaignState,
    EvaluationFilter,
    FailureFilter,
)
from drivora_service.store.failures.failure_records import FoundFilter
from drivora_service.store.runs.run_records import BatchState, JobFilter, Priority
from drivora_service.studies.table_names import CampaignTableName, ResultTableName, TableForm


def broken(scenario: dict[str, Any]) -> dict[str, Any]:
    return {**scenario, "map_region": {**scenario["map_region"], "town": "nowhere"}}


@pytest.fixture(scope="module")
def runs(client: Client) -> tuple[Run, ...]:
    """The runs of a batch of three that has ended."""
    submission = client.post_batch([SCENARIO] * 3, name="three", seed=7)
    return tuple(client.wait_for_batch(submission.batch.id))


def small_campaign(tester: str, seed: int = 3) -> dict[str, Any]:
    return {
        **copy.deepcopy(CAMPAIGN),
        "name": f"tee, {tester}",
        "tester": {"name": tester},
        "space": {"vehicles": 2, "walkers": 1},
        "oracles": ["collision", "discomfort"],
        "budget": {"simulations": 6},
        "seed": seed,
    }


@pytest.fixture(scope="module")
def campaign(client: Client) -> Campaign:
    """A campaign that has finished, with failures."""
    seen: list[Campaign] = []
    posted = client.post_campaign(small_campaign("random"))
    ended = client.follow_campaign(posted.id, on_progress=seen.append)
    assert ended.state is CampaignState.FINISHED, ended.message
    assert seen[-1] == ended
    counts = [one.counts.evaluations for one in seen]
    assert counts == sorted(counts)
    return ended


def test_the_state_of_the_service(client: Client, is_local: bool) -> None:
    assert client.health().status == "ok"
    readiness = client.readiness()
    assert readiness.ready
    expected = {"workers"} if is_local else {"workers", "database"}
    assert expected <= {check.name for check in readiness.checks}
    client.expect_workers()
    assert "# TYPE" in client.metrics()


def test_the_catalogues(client: Client) -> None:
    names = [network.name for network in client.networks().items]
    network = client.network("tee-town")
    assert network.name in names
    assert network.lanes > 0
    geometry = client.network_geometry("tee-town")
    assert (geometry.sha256, len(geometry.lanes)) == (network.sha256, network.lanes)
    assert "idm" in [agent.name for agent in client.agents().items]
    assert "random" in [tester.name for tester in client.testers().items]
    assert "collision" in [oracle.name for oracle in client.oracles().items]
    assert "vehicle.tesla.model3" in [model.name for model in client.models().items]


def test_a_scenario_that_can_be_run(client: Client, scenario: dict[str, Any]) -> None:
    valid = client.validate_scenario(scenario, agent="sumo-krauss")
    assert (valid.valid, valid.town, valid.agents) == (True, "tee-town", ("sumo-krauss",))
    text = json.dumps(scenario)
    for document in (text, text.encode()):
        assert client.validate_scenario(document).scenario_sha256 == valid.scenario_sha256
    assert client.validate_scenario(text, language="yaml").town == "tee-town"


def test_a_scenario_that_is_being_written(client: Client, scenario: dict[str, Any]) -> None:
    found = client.inspect_scenario(scenario)
    assert (found.valid, found.town, len(found.actors)) == (True, "tee-town", 1)
    assert found.actors[0].path[0] == pytest.approx((11.77, 19.81), abs=2.0)
    found = client.inspect_scenario(json.dumps(broken(scenario)))
    assert [problem.pointer for problem in found.problems] == ["/map_region/town"]
    assert (found.valid, found.actors) == (False, ())


def test_a_scenario_with_problems(client: Client, scenario: dict[str, Any]) -> None:
    for refused in (client.validate_scenario, client.post_job):
        with pytest.raises(InvalidDocument) as raised:
            refused(broken(scenario))
        (problem,) = raised.value.problems
        assert (problem.pointer, problem.code) == ("/map_region/town", "unknown_town")
        assert "nowhere" in problem.message
    with pytest.raises(InvalidDocument) as raised:
        client.post_batch([broken(scenario)] * 2)
    assert [problem.pointer for problem in raised.value.problems] == [
        "/0/map_region/town",
        "/1/map_region/town",
    ]


def test_a_job(client: Client, scenario: dict[str, Any]) -> None:
    posted = client.post_job(scenario, label="alone", seed=3)
    job = client.job(posted.id)
    assert (job.label, job.seed, job.batch_id) == ("alone", 3, "")
    assert client.cancel_job(posted.id).id == posted.id
    assert posted.id in [one.id for one in client.jobs(limit=5)]


def test_a_job_runs_to_its_end(client: Client, scenario: dict[str, Any]) -> None:
    posted = client.post_job(scenario, label="to its end")
    deadline = time.monotonic() + 60.0
    while not (job := client.job(posted.id)).status.is_final:
        assert time.monotonic() < deadline, job
        time.sleep(0.1)
    assert job.status is RunStatus.FINISHED


def test_runs_of_a_batch_come_once_each(client: Client, runs: tuple[Run, ...]) -> None:
    assert sorted(run.item for run in runs) == [0, 1, 2]
    assert {run.status for run in runs} == {RunStatus.FINISHED}
    assert len({run.trace_sha256 for run in runs}) == 1
    for run in runs:
        assert run == client.run(run.id)
        assert run.metrics
        assert run.verdicts
        assert run.seed == 7
        assert run.created_at.tzinfo is not None


def test_runs_of_a_batch_have_the_labels_of_its_scenarios(
    client: Client, scenario: dict[str, Any]
) -> None:
    texts = json.dumps(broken(scenario)), json.dumps(scenario).encode()
    submission = client.post_batch([scenario, *texts], labels=["a", "b", 'ü "c"'])
    first, rejected, last = submission.items
    assert [client.job(item.job_id).label for item in (first, last)] == ["a", 'ü "c"']
    assert [problem.pointer for problem in rejected.problems] == ["/scenario/map_region/town"]
    client.cancel_batch(submission.batch.id)
    with pytest.raises(InvalidDocument) as raised:
        client.post_batch([broken(scenario)], labels=["a"])
    assert [p.pointer for p in raised.value.problems] == ["/0/scenario/map_region/town"]
    with pytest.raises(ValueError, match="found 1 labels for 2 scenarios"):
        client.post_batch([scenario, scenario], labels=["a"])


def test_runs_of_a_batch_have_seeds_of_their_own(client: Client, scenario: dict[str, Any]) -> None:
    labels, seeds = ["a", "a", "a"], [None, 0, 5]
    submission = client.post_batch([scenario] * 3, labels=labels, seeds=seeds, seed=7)
    assert [client.job(item.job_id).seed for item in submission.items] == [7, 0, 5]
    client.cancel_batch(submission.batch.id)
    with pytest.raises(ValueError, match="found 1 seeds for 2 scenarios"):
        client.post_batch([scenario] * 2, labels=["a", "b"], seeds=[1])
    with pytest.raises(ValueError, match="seeds for scenarios without labels"):
        client.post_batch([scenario], seeds=[1])


def test_a_batch_with_a_scenario_that_is_rejected(client: Client, scenario: dict[str, Any]) -> None:
    seen: list[Batch] = []
    submission = client.post_batch([broken(scenario), scenario], priority=Priority.INTERACTIVE)
    assert (submission.accepted, submission.rejected) == (1, 1)
    assert [item.result for item in submission.items] == [
        ItemResult.REJECTED,
        ItemResult.ACCEPTED,
    ]
    assert submission.items[0].problems[0].pointer == "/map_region/town"
    assert submission.batch.priority is Priority.INTERACTIVE
    (listed,) = client.batches([Priority.INTERACTIVE], limit=1)
    assert listed.id == submission.batch.id
    others = client.batches([Priority.CI, Priority.CAMPAIGN])
    assert submission.batch.id not in [batch.id for batch in others]
    (run,) = client.wait_for_batch(submission.batch.id, on_progress=seen.append)
    assert run.id == submission.items[1].job_id
    assert seen[-1].done
    assert seen[-1] == client.batch(submission.batch.id)


def test_lists_of_runs_with_filters_and_limits(client: Client, runs: tuple[Run, ...]) -> None:
    batch_id = runs[0].batch_id
    wanted = JobFilter(batch_id=batch_id, statuses=frozenset({RunStatus.FINISHED}), town="tee-town")
    listed = tuple(client.runs(wanted))
    assert [run.item for run in listed] == [2, 1, 0]
    assert listed == tuple(client.jobs(wanted))
    assert tuple(client.runs(wanted, limit=2)) == listed[:2]
    assert tuple(client.runs(wanted, limit=0)) == ()
    none = JobFilter(batch_id=batch_id, statuses=frozenset({RunStatus.QUEUED, RunStatus.RUNNING}))
    assert tuple(client.runs(none)) == ()
    assert tuple(client.runs(JobFilter(batch_id=batch_id, violated=True))) == tuple(
        run for run in listed if run.violations
    )


def test_what_a_run_recorded(client: Client, runs: tuple[Run, ...], tmp_path: Path) -> None:
    run = runs[0]
    parquet = client.run_observations(run.id)
    table = pq.read_table(io.BytesIO(parquet))
    assert table.column("step").to_pylist()[-1] + 1 == run.steps
    lines = client.run_observations(run.id, form=ObservationForm.NDJSON, first=2, last=4)
    assert len([json.loads(line) for line in lines.splitlines()]) == 3
    arrow = client.run_observations(
        run.id, form=ObservationForm.ARROW, rows=TraceRows.EGOS, columns=["x"], first=2, last=4
    )
    part = pa.ipc.open_stream(arrow).read_all()
    assert (part.column_names, part.num_rows) == (["step", "actor", "x"], 3)
    path = tmp_path / "new" / "run.trace.parquet"
    client.save_run_observations(path, run.id)
    assert path.read_bytes() == parquet
    assert list(path.parent.iterdir()) == [path]


def test_a_scenario_of_a_run_can_be_posted_again(client: Client, runs: tuple[Run, ...]) -> None:
    """The seed that was given beside the document is in it."""
    text = client.run_scenario(runs[0].id)
    assert client.validate_scenario(text).scenario_sha256 != runs[0].scenario_sha256
    submission = client.post_batch([text])
    (again,) = client.wait_for_batch(submission.batch.id)
    assert again.trace_sha256 == runs[0].trace_sha256
    repeated = client.run_scenario(again.id)
    assert client.validate_scenario(repeated).scenario_sha256 == again.scenario_sha256


def test_a_batch_is_paused_resumed_and_cancelled(client: Client, scenario: dict[str, Any]) -> None:
    batch = client.post_batch([scenario] * 2).batch
    assert client.pause_batch(batch.id).state is BatchState.PAUSED
    assert client.resume_batch(batch.id).state is BatchState.OPEN
    assert client.cancel_batch(batch.id).state is BatchState.CANCELLED
    assert [one.id for one in client.batches(limit=1)] == [batch.id]
    with pytest.raises(RequestConflict, match="cancelled") as raised:
        client.resume_batch(batch.id)
    assert raised.value.status == 409
    assert len(tuple(client.wait_for_batch(batch.id))) == 2


def test_what_is_not_there(client: Client, tmp_path: Path) -> None:
    for ask in (client.job, client.run, client.batch, client.campaign, client.network):
        with pytest.raises(NotFound) as raised:
            ask("no/such?thing:1")
        assert raised.value.status == 404
    path = tmp_path / "trace"
    with pytest.raises(NotFound):
        client.save_run_observations(path, "none")
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(NotFound, match="none"):
        tuple(client.wait_for_batch("none"))
    with pytest.raises(NotFound):
        client.follow_campaign("none")


def test_errors_say_what_the_service_says(client: Client, is_local: bool) -> None:
    with pytest.raises(NotFound) as raised:
        client.run("none")
    refused = "" if is_local else "the service refused: "
    assert str(raised.value).startswith(f"{refused}unknown run 'none'")


def test_a_parameter_that_the_service_refuses(client: Client, scenario: dict[str, Any]) -> None:
    with pytest.raises(InvalidDocument, match="seed"):
        client.post_job(scenario, seed=-1)


def test_a_campaign_and_its_lists(client: Client, campaign: Campaign) -> None:
    assert client.campaign(campaign.id) == campaign
    assert campaign.simulations == 6
    assert campaign.kinds
    listed = tuple(client.campaigns([CampaignState.FINISHED], limit=10))
    assert campaign.id in [one.id for one in listed]
    assert tuple(client.campaigns([CampaignState.PAUSED])) == ()
    validation = client.validate_campaign(dict(campaign.document))
    assert (validation.tester, validation.town) == ("random", "tee-town")


def test_a_study_of_what_there_is_to_begin_with(client: Client) -> None:
    example, *_ = client.example_scenarios().items
    _, preset, *_ = client.space_presets().items
    study = {
        "name": "checked",
        "scenarios": [{"document": example.document}],
        "methods": [{"name": "random"}],
        "repetitions": 3,
        "space": {"preset": preset.name},
        "budget": {"simulations": 2},
    }
    checked = client.validate_study(study)
    assert (checked.campaigns, checked.simulations) == (3, 6)
    assert preset.description in checked.notes[0]
    with pytest.raises(InvalidDocument, match="agents"):
        client.validate_study({**study, "agents": [{"name": "none"}]})


def test_the_evaluations_of_a_campaign(client: Client, campaign: Campaign) -> None:
    evaluations = tuple(client.evaluations(campaign.id))
    assert [one.number for one in evaluations] == list(range(campaign.counts.evaluations))
    newest = tuple(client.evaluations(campaign.id, newest_first=True, limit=2))
    assert newest == evaluations[:-3:-1]
    judged = EvaluationFilter(status=EvaluationStatus.JUDGED, violating=True)
    violating = tuple(client.evaluations(campaign.id, judged))
    assert violating == tuple(one for one in evaluations if one.violations)
    detail = client.evaluation(campaign.id, violating[0].number)
    assert detail.failures
    assert detail.genes
    assert detail.number == violating[0].number
    text = client.evaluation_scenario(campaign.id, detail.number)
    assert client.validate_scenario(text).scenario_sha256 == detail.scenario_sha256
    with pytest.raises(NotFound):
        client.evaluation(campaign.id, 10_000)


def test_the_failures_of_a_campaign(client: Client, campaign: Campaign, tmp_path: Path) -> None:
    failures = tuple(client.failures(campaign.id))
    assert {failure.kind for failure in failures} == {kind.kind for kind in campaign.kinds}
    kind = failures[0].kind
    assert tuple(client.failures(campaign.id, FailureFilter(kind=kind))) == tuple(
        failure for failure in failures if failure.kind == kind
    )
    recorded = next(failure for failure in failures if failure.trace)
    path = tmp_path / recorded.trace
    client.save_evaluation_observations(path, campaign.id, recorded.evaluation)
    assert path.read_bytes() == client.evaluation_observations(campaign.id, recorded.evaluation)


def test_the_figures_of_a_campaign(client: Client, campaign: Campaign) -> None:
    answer = client.figures(campaign.id)
    assert answer.figures is not None
    assert answer.figures.campaign == campaign.id
    assert answer.figures.simulations == campaign.simulations


def test_a_comparison_of_batches(client: Client, runs: tuple[Run, ...]) -> None:
    other = client.post_batch([SCENARIO] * 2, agent="sumo-krauss", seed=7).batch.id
    assert len(list(client.wait_for_batch(other))) == 2
    found = client.compare_batches(
        runs[0].batch_id, other, counts=Counted.ANY, metrics=["success", "comfort"]
    )
    assert (found.scenarios, len(found.pairs), len(found.left_out)) == (1, 2, 1)
    assert found.definition.counts is Counted.ANY
    assert [row.metric for row in found.metrics] == ["success", "comfort"]
    assert (found.a.title, found.b.title) == ("idm", "sumo-krauss")
    named = client.compare_batches("three", other, oracles=["speeding"])
    assert named.definition.oracles == ("speeding",)
    with pytest.raises(NotFound, match="unknown batch"):
        client.compare_batches(other, "nobody")


def test_a_comparison_of_campaigns(client: Client, campaign: Campaign) -> None:
    others = [
        client.post_campaign(json.dumps(small_campaign(tester, seed))).id
        for tester, seed in (("random", 4), ("avfuzzer", 3), ("avfuzzer", 4))
    ]
    for other in others:
        assert client.follow_campaign(other).state is CampaignState.FINISHED
    wanted = [campaign.id, *others]
    comparison = client.compare_campaigns(wanted, measures=["failing", "kinds"], equal_time=True)
    assert comparison.baseline == "random"
    assert {one.campaign for one in comparison.campaigns} == set(wanted)
    assert [one.measure for one in comparison.differences] == ["failing", "kinds"]
    assert comparison.time_limits_s
    with pytest.raises(ServiceError, match="one campaign of 'random' only") as raised:
        client.compare_campaigns([campaign.id, *others[1:]])
    assert raised.value.status == 422


def test_a_campaign_that_is_over_is_neither_paused_nor_resumed(
    client: Client, campaign: Campaign
) -> None:
    for act in (client.pause_campaign, client.resume_campaign, client.cancel_campaign):
        with pytest.raises(RequestConflict, match="finished"):
            act(campaign.id)


def test_a_campaign_is_paused_resumed_and_cancelled(client: Client) -> None:
    document = {**copy.deepcopy(CAMPAIGN), "budget": {"simulations": 500}, "name": "long"}
    posted = client.post_campaign(document)
    client.pause_campaign(posted.id)
    assert client.follow_campaign(posted.id).state is CampaignState.PAUSED
    resumed = client.resume_campaign(posted.id)
    assert resumed.state in (CampaignState.QUEUED, CampaignState.RUNNING)
    client.cancel_campaign(posted.id)
    assert client.follow_campaign(posted.id).state is CampaignState.CANCELLED


def test_the_curves_the_coverage_and_the_tables_of_a_campaign(
    client: Client, campaign: Campaign
) -> None:
    found = client.discoveries(campaign.id, points=5)
    assert found.simulations == campaign.simulations
    assert found.avoidable[-1] + found.others[-1] == campaign.counts.violating
    coverage = client.coverage(campaign.id)
    assert (coverage.counted, coverage.simulations) == (6, 6)
    content = client.campaign_table(
        campaign.id, CampaignTableName.EVALUATIONS, columns=["evaluation", "violations"]
    )
    table = pq.read_table(io.BytesIO(content))
    assert table.column_names == ["evaluation", "violations"]
    assert table.num_rows == campaign.counts.evaluations


def test_failures_of_all_campaigns_and_their_groups(client: Client, campaign: Campaign) -> None:
    wanted = FoundFilter(campaign_id=campaign.id)
    found = tuple(client.found_failures(wanted))
    assert [(one.evaluation, one.place) for one in reversed(found)] == [
        (one.evaluation, one.place) for one in client.failures(campaign.id)
    ]
    assert client.found_failure(found[0].id) == found[0]
    groups = tuple(client.failure_groups(wanted))
    assert sum(group.failures for group in groups) == len(found)
    recorded = next(one for one in found if one.picture_url)
    assert recorded.evaluation is not None
    picture = client.evaluation_picture(campaign.id, recorded.evaluation, moments=2)
    assert b"<svg" in picture


def test_runs_are_counted_drawn_and_put_into_a_table(
    client: Client, runs: tuple[Run, ...], tmp_path: Path
) -> None:
    wanted = JobFilter(batch_id=runs[0].batch_id)
    assert client.run_counts(wanted).total == len(runs)
    oldest = tuple(client.runs(wanted, oldest_first=True))
    assert [run.id for run in oldest] == [run.id for run in reversed(tuple(client.runs(wanted)))]
    content = client.result_table(
        ResultTableName.RUNS, batches=[runs[0].batch_id], columns=["run_id"]
    )
    table = pq.read_table(io.BytesIO(content))
    assert table.column("run_id").to_pylist() == [run.id for run in oldest]
    same = JobFilter(batch_id=runs[0].batch_id, agent=runs[0].agent)
    assert client.result_table(ResultTableName.RUNS, wanted=same, columns=["run_id"]) == content
    with pytest.raises(NotFound, match="unknown study 'x'"):
        client.result_table(ResultTableName.AGENTS, studies=["x"])
    client.save_result_table(
        tmp_path / "verdicts.csv",
        ResultTableName.VERDICTS,
        batches=[runs[0].batch_id],
        form=TableForm.CSV,
    )
    with (tmp_path / "verdicts.csv").open(newline="") as file:
        verdicts = list(csv.DictReader(file))
    assert [(one["run_id"], one["oracle"]) for one in verdicts] == [
        (run.id, verdict.oracle) for run in oldest for verdict in client.run(run.id).verdicts
    ]
    assert b"<svg" in client.run_picture(runs[0].id, moments=2)


def test_metrics_are_described(client: Client, runs: tuple[Run, ...]) -> None:
    described = {one.name for one in client.describe_metrics().items}
    assert set(runs[0].metrics) <= described


def test_a_network_is_imported(client: Client, tmp_path: Path) -> None:
    source = tmp_path / "town.net.xml"
    source.write_bytes((shipped_networks() / "tee-town" / "tee-town.net.xml").read_bytes())
    # Clients of several kinds ask the same service.
    name = f"town-{uuid.uuid4().hex}"
    imported = client.import_network(source, name)
    assert imported == client.network(name)
    assert imported.sha256 == client.network("tee-town").sha256
    with pytest.raises(RequestConflict, match=f"'{name}' is already imported"):
        client.import_network(source, name)
    source.write_text(source.read_text().replace("</net>", "<!-- again --></net>"))
    replaced = client.import_network(source, name, form=SourceFormat.SUMO, replace=True)
    assert replaced.sha256 != imported.sha256
    assert client.network_geometry(name).sha256 == replaced.sha256


def test_a_file_that_is_no_network(client: Client, tmp_path: Path) -> None:
    source = tmp_path / "town.net.xml"
    source.write_text("<net/>")
    with pytest.raises(ServiceError, match="cannot import the file"):
        client.import_network(source, "no-town")
    with pytest.raises(StoreError, match="No such file"):
        client.import_network(tmp_path / "none.net.xml", "no-town")
    with pytest.raises(NetworkError, match=r"allowed are \.net\.xml"):
        client.import_network(tmp_path / "town.shp", "no-town")
