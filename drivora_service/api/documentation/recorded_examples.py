"""The examples of the API's documentation: requests, and the answers of a service.

The answers lie in ``recorded``, where ``make api-examples`` writes them anew; nothing is read
before the OpenAPI document is made.
"""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

RECORDED = "recorded:"
"""Prefix of what stands for an answer until it is read; the name of its file follows."""

SCENARIO: dict[str, Any] = {
    "version": "1.0",
    "map_region": {"town": "tee-town"},
    "ego_vehicles": [
        {
            "id": "ego",
            "model": "vehicle.lincoln.mkz_2017",
            "route": [
                {"x": 11.77, "y": 19.81, "yaw": 125.36},
                {"x": 3.01, "y": 104.32, "yaw": 91.51},
            ],
            "agent": {"name": "idm"},
        }
    ],
    "seed": 1,
}
CAMPAIGN: dict[str, Any] = {
    "name": "tee, AVFuzzer",
    "tester": {"name": "avfuzzer"},
    "agent": {"name": "idm"},
    "scenario": SCENARIO,
    "space": {"vehicles": 3, "walkers": 1},
    "budget": {"simulations": 200},
    "seed": 1,
}
STUDY: dict[str, Any] = {
    "name": "tee, two methods",
    "scenarios": [{"label": "tee", "document": SCENARIO}],
    "agents": [{"name": "idm"}, {"name": "idm-mobil"}],
    "methods": [{"name": "random"}, {"name": "avfuzzer"}],
    "repetitions": 20,
    "space": {"vehicles": 3, "walkers": 1},
    "budget": {"simulations": 200},
}

NETWORK_FILE = '<net version="1.20">…</net>'
"""Stands for the file of a network."""

HEALTH = RECORDED + "health.json"
READINESS = RECORDED + "readiness.json"
NOT_READY = RECORDED + "not-ready.json"
METRICS = RECORDED + "metrics.txt"

NETWORKS = RECORDED + "networks.json"
NETWORK = RECORDED + "network.json"
GEOMETRY = RECORDED + "geometry.json"
AGENTS = RECORDED + "agents.json"
TESTERS = RECORDED + "testers.json"
MEASURES = RECORDED + "measures.json"
ORACLES = RECORDED + "oracles.json"
MODELS = RECORDED + "models.json"

EXAMPLE_SCENARIOS = RECORDED + "example-scenarios.json"
FOUND_ID = RECORDED + "found-id.json"
VALIDATION = RECORDED + "validation.json"
INSPECTION = RECORDED + "inspection.json"
JOB = RECORDED + "job.json"
QUEUED_JOB = RECORDED + "queued-job.json"
CANCELLED_JOB = RECORDED + "cancelled-job.json"
JOBS = RECORDED + "jobs.json"
SUBMISSION = RECORDED + "submission.json"
BATCH = RECORDED + "batch.json"
PAUSED_BATCH = RECORDED + "paused-batch.json"
RESUMED_BATCH = RECORDED + "resumed-batch.json"
CANCELLED_BATCH = RECORDED + "cancelled-batch.json"
BATCHES = RECORDED + "batches.json"
BATCH_COMPARISON = RECORDED + "batch-comparison.json"
RUN = RECORDED + "run.json"
RUNS = RECORDED + "runs.json"
RUN_COUNTS = RECORDED + "run-counts.json"
RESULT_TABLE = RECORDED + "verdicts.csv"
PICTURE = RECORDED + "picture.svg"
RUN_SCENARIO = RECORDED + "run-scenario.json"
FRAME = RECORDED + "frame.ndjson"
PERCEPTION = RECORDED + "perception.json"
SERIES = RECORDED + "series.json"
TIMELINE = RECORDED + "timeline.json"

QUEUED_MINIMIZATION = RECORDED + "queued-minimization.json"
CANCELLED_MINIMIZATION = RECORDED + "cancelled-minimization.json"
FINISHED_MINIMIZATION = RECORDED + "finished-minimization.json"
MINIMIZATIONS = RECORDED + "minimizations.json"

SPACE_PRESETS = RECORDED + "space-presets.json"
CAMPAIGN_VALIDATION = RECORDED + "campaign-validation.json"
QUEUED_CAMPAIGN = RECORDED + "queued-campaign.json"
PAUSED_CAMPAIGN = RECORDED + "paused-campaign.json"
RESUMED_CAMPAIGN = RECORDED + "resumed-campaign.json"
CANCELLED_CAMPAIGN = RECORDED + "cancelled-campaign.json"
FINISHED_CAMPAIGN = RECORDED + "finished-campaign.json"
CAMPAIGNS = RECORDED + "campaigns.json"
FIGURES = RECORDED + "figures.json"
COVERAGE = RECORDED + "coverage.json"
DISCOVERIES = RECORDED + "discoveries.json"
EVALUATIONS = RECORDED + "evaluations.json"
EVALUATION = RECORDED + "evaluation.json"
EVALUATION_SCENARIO = RECORDED + "evaluation-scenario.json"
EVALUATION_FRAME = RECORDED + "evaluation-frame.ndjson"
FAILURES = RECORDED + "failures.json"
CAMPAIGN_TABLE = RECORDED + "campaign-failures.csv"
FOUND_FAILURES = RECORDED + "found-failures.json"
FOUND_COUNTS = RECORDED + "found-counts.json"
FOUND_FAILURE = RECORDED + "found-failure.json"
FAILURE_GROUPS = RECORDED + "failure-groups.json"
FAILURE_GROUP = RECORDED + "failure-group.json"
GROUP_CHANGES = RECORDED + "group-changes.json"

SUITES = RECORDED + "suites.json"
SUITE_HISTORY = RECORDED + "suite-history.json"
SUITE_RUNS = RECORDED + "suite-runs.json"
SUITE_RUN = RECORDED + "suite-run.json"
SUITE_RUN_REQUEST: dict[str, Any] = {
    "decision": {
        "suite": "smoke",
        "agent": "idm",
        "agent_parameters": [],
        "configuration": "idm",
        "configuration_id": "c4b436a4",
        "fails": True,
        "sentence": "Gate failed: 1 new against the baseline; 1 of 2 scenarios fail in 2 judged "
        "runs",
        "reasons": ["1 new failure"],
        "counts": {"new": 1},
        "baseline": "baseline.json",
        "scenarios": 2,
        "passing": 1,
        "judged_runs": 2,
        "pass_rate": {"mean": 0.5, "low": 0.09, "high": 0.91},
        "score": {"mean": 82.5, "low": 66.1, "high": 98.9},
        "versions": {"drivora": "0.1.0"},
        "definition": "violations that an ego is accountable for (accountable), of all oracles but "
        "observations",
    },
    "outcomes": [
        {
            "scenario": "cut-in",
            "state": "fails_gate",
            "failing": 1,
            "judged": 1,
            "score": 65.0,
            "run_id": "0193a5b0c4d200000000001d",
            "failures": ["collision: Collided with a vehicle at 4.2 m/s relative to it."],
        },
        {
            "scenario": "left-turn",
            "state": "passes",
            "failing": 0,
            "judged": 1,
            "score": 100.0,
            "run_id": "0193a5b0c4d200000000001e",
            "failures": [],
        },
    ],
}
COMPARISON = RECORDED + "comparison.json"

STUDY_VALIDATION = RECORDED + "study-validation.json"
QUEUED_STUDY = RECORDED + "queued-study.json"
PAUSED_STUDY = RECORDED + "paused-study.json"
RESUMED_STUDY = RECORDED + "resumed-study.json"
CANCELLED_STUDY = RECORDED + "cancelled-study.json"
FINISHED_STUDY = RECORDED + "finished-study.json"
STUDIES = RECORDED + "studies.json"
STUDY_COMPARISON = RECORDED + "study-comparison.json"
STUDY_BANDS = RECORDED + "study-bands.json"
SESSION = RECORDED + "session.json"
WORKERS = RECORDED + "workers.json"
EVENTS = RECORDED + "events.txt"
STUDY_TABLE = RECORDED + "study-campaigns.csv"


def read_recorded(example: str) -> Any:
    """Reads a recorded answer.

    Args:
        example: One of the names above.

    Returns:
        A JSON value; the text of what is no JSON.
    """
    file = files(__package__) / "recorded" / example.removeprefix(RECORDED)
    text = file.read_text(encoding="utf-8")
    return json.loads(text) if file.name.endswith(".json") else text
