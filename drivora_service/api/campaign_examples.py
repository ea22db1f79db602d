"""One example of everything about campaigns that the API takes and gives."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

from drivora_service.api.examples import SCENARIO
from drivora_service.api.schemas import campaigns, comparisons
from drivora_service.api.schemas.base import PageOf
from drivora_service.api.schemas.runs import AgentView, VerdictView
from drivora_service.oracles.accountability import Accountability
from drivora_service.oracles.verdict import Answer, Outcome, Severity
from drivora_service.runs.report import RunStatus
from drivora_service.search.genes import GeneKind, Part
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaign_records import (
    CampaignRequest,
    CampaignState,
    Confirmation,
)

_ID = "0193a5b0c4d29f3e7a61c8d1"
_BATCH_ID = "0193a5b0c4d1e2b7905f4c3b"
_URL = f"/api/v1/campaigns/{_ID}"
_SHA256 = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08"
_POSTED = datetime(2026, 3, 2, 9, 30, tzinfo=UTC)
_STARTED = datetime(2026, 3, 2, 9, 30, 4, tzinfo=UTC)
_NOW = datetime(2026, 3, 2, 9, 30, 21, tzinfo=UTC)
_KEY = "collision|junction centre|vehicle, front"

DOCUMENT: dict[str, Any] = {
    "name": "tee, AVFuzzer",
    "tester": {"name": "avfuzzer"},
    "agent": {"name": "idm"},
    "scenario": SCENARIO,
    "space": {"vehicles": 3, "walkers": 1},
    "budget": {"simulations": 200},
    "seed": 1,
}

_SUMMARY: dict[str, Any] = {
    "id": _ID,
    "name": "tee, AVFuzzer",
    "state": CampaignState.QUEUED,
    "message": "",
    "request": CampaignRequest.NONE,
    "tester": "avfuzzer",
    "agent": "idm",
    "town": "tee-town",
    "budget": 200,
    "simulations": 0,
    "counts": campaigns.Counts(
        evaluations=0,
        judged=0,
        invalid=0,
        failed=0,
        violating=0,
        at_fault=0,
        avoidable=0,
        unavoidable=0,
        undetermined=0,
    ),
    "rate": None,
    "left_s": None,
    "active_s": 0.0,
    "created_at": _POSTED,
    "started_at": None,
    "ended_at": None,
    "updated_at": _POSTED,
}
_RUNNING: dict[str, Any] = {
    **_SUMMARY,
    "state": CampaignState.RUNNING,
    "simulations": 118,
    "counts": campaigns.Counts(
        evaluations=120,
        judged=118,
        invalid=2,
        failed=0,
        violating=7,
        at_fault=5,
        avoidable=3,
        unavoidable=1,
        undetermined=1,
    ),
    "rate": 9.44,
    "left_s": 8.69,
    "active_s": 12.5,
    "started_at": _STARTED,
    "updated_at": _NOW,
}
_REST: dict[str, Any] = {
    "document": {**DOCUMENT, "version": "1.0", "lookahead": 8},
    "network_sha256": _SHA256,
    "versions": {"drivora": "0.1.0", "numpy": "2.2.6"},
    "batch_id": _BATCH_ID,
    "evaluations_url": f"{_URL}/evaluations",
    "failures_url": f"{_URL}/failures",
    "runs_url": f"/api/v1/runs?batch={_BATCH_ID}",
}

QUEUED = campaigns.Campaign(**_SUMMARY, **_REST, best={}, kinds=())
RUNNING = campaigns.Campaign(
    **_RUNNING,
    **_REST,
    best={"min_gap": campaigns.BestValue(value=0.0, evaluation=41)},
    kinds=(
        campaigns.Kind(
            key=_KEY,
            failures=5,
            violations=6,
            at_fault=5,
            avoidable=3,
            confirmed=0,
            flaky=0,
            first=41,
            clusters=None,
        ),
    ),
)
CAMPAIGNS = PageOf[campaigns.CampaignSummary](items=(campaigns.CampaignSummary(**_RUNNING),))
VALIDATION = campaigns.CampaignValidation(
    valid=True, tester="avfuzzer", town="tee-town", genes=70, notes=()
)

_EVALUATION: dict[str, Any] = {
    "number": 41,
    "generation": 3,
    "origin": "mutation",
    "parents": (17,),
    "status": EvaluationStatus.JUDGED,
    "scenario_sha256": _SHA256,
    "violations": 1,
    "at_fault_violations": 1,
    "accountability": Accountability.AVOIDABLE,
    "failure_keys": (_KEY,),
    "objectives": {"min_gap": 0.0},
    "cause": "",
    "sim_time_s": 21.0,
    "wall_time_s": 0.11,
    "told_at": _NOW,
}
_VERDICT = VerdictView(
    oracle="collision",
    ego="ego",
    outcome=Outcome.VIOLATED,
    message="hit vehicle_1 with its front at 7.4 m/s",
    severity=Severity.CRITICAL,
    at_fault=True,
    undetermined=False,
    avoidable=Answer.YES,
    physically_avoidable=Answer.YES,
    time=20.95,
    step=419,
    location=(120.4, 98.4),
    counterpart="vehicle_1",
    evidence={"counterpart_role": "vehicle", "face": "front", "ego_speed": 7.4},
)
_PARENT = campaigns.Evaluation(
    **{
        **_EVALUATION,
        "number": 17,
        "generation": 2,
        "origin": "initial",
        "parents": (),
        "violations": 0,
        "at_fault_violations": 0,
        "accountability": None,
        "failure_keys": (),
        "objectives": {"min_gap": 1.7},
    }
)

EVALUATIONS = PageOf[campaigns.Evaluation](items=(campaigns.Evaluation(**_EVALUATION),))
EVALUATION = campaigns.EvaluationDetail(
    **_EVALUATION,
    genes=(
        campaigns.Block(
            name="weather",
            part=Part.WEATHER,
            genes=(
                campaigns.Gene(
                    name="precipitation",
                    value=37.5,
                    low=0.0,
                    high=100.0,
                    unit="%",
                    kind=GeneKind.CONTINUOUS,
                ),
            ),
        ),
    ),
    values=(37.5,),
    lineage=(_PARENT,),
    error=None,
    failures=(_VERDICT,),
    verdicts=(_VERDICT,),
    scores={"min_gap": 0.0, "time_to_collision": None},
    metrics={"route_completion": 63.0},
    features={},
    run_id=f"{_ID}-41",
    run_status=RunStatus.FINISHED,
    steps=421,
    step_cost_us=118.0,
    agent_cost_us={"ego_0": 31.0},
    agents={"ego_0": AgentView(name="idm", parameters={"speed_factor": 1.0})},
    privileged=(),
    trace_sha256=_SHA256,
    versions={"drivora": "0.1.0", "libsumo": "1.28.0"},
    search_s=0.0012,
    prepare_s=0.0041,
    scenario_url=f"{_URL}/evaluations/41/scenario",
    observations_url=f"{_URL}/evaluations/41/observations",
    run_url=f"/api/v1/runs/{_ID}-41",
)
FAILURES = PageOf[campaigns.FailureView](
    items=(
        campaigns.FailureView(
            evaluation=41,
            place=0,
            key=_KEY,
            confirmation=Confirmation.CONFIRMED,
            cluster=0,
            verdict=_VERDICT,
            scenario_url=f"{_URL}/evaluations/41/scenario",
            observations_url=f"{_URL}/evaluations/41/observations",
        ),
    )
)
_FIGURES = comparisons.Figures(
    campaign=_ID,
    group="avfuzzer",
    scenario="tee-town",
    seed=1,
    simulations=200,
    budget=200,
    invalid_share=0.01,
    failed_share=0.0,
    failing=11,
    at_fault=9,
    avoidable=6,
    unavoidable=2,
    undetermined=1,
    kinds=3,
    rules=2,
    clusters=4,
    situations=6,
    first_failure=17,
    found=(17, 41, 96),
    gene_coverage=0.71,
    network_coverage=0.2,
    simulation_s=24.2,
    own_s=1.1,
    own_share=0.045,
    first_failure_s=2.1,
    time_limit_s=None,
)
FIGURES = comparisons.CampaignFiguresView(figures=_FIGURES, note="")
COMPARISON = comparisons.ComparisonView(
    baseline="random",
    budgets={"tee-town": 200},
    time_limits_s={},
    notes=(),
    differences=(
        comparisons.Difference(
            measure="at_fault",
            title="simulations with an at-fault failure",
            larger_is_better=True,
            scenario="tee-town",
            group="avfuzzer",
            repetitions=20,
            baseline_repetitions=20,
            median=9.0,
            baseline_median=4.5,
            a12=0.83,
            low=0.67,
            high=0.92,
            p=0.0003,
            p_holm=0.0003,
            judgement="better, large",
        ),
    ),
    campaigns=(_FIGURES,),
)
