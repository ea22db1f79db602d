"""One example of everything that the API takes and gives, for its documentation."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

from drivora_service.api.problems import ProblemItem
from drivora_service.api.schemas import batches, catalogues, jobs, runs, service
from drivora_service.api.schemas.base import PageOf
from drivora_service.oracles.accountability import Accountability
from drivora_service.oracles.verdict import Answer, Outcome, Severity
from drivora_service.runs.report import RunStatus
from drivora_service.store.records import BatchState

_ID = "0193a5b0c4d29f3e7a61c8d0"
_BATCH_ID = "0193a5b0c4d1e2b7905f4c3a"
_SHA256 = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08"
_POSTED = datetime(2026, 3, 2, 9, 30, tzinfo=UTC)
_STARTED = datetime(2026, 3, 2, 9, 30, 1, tzinfo=UTC)
_ENDED = datetime(2026, 3, 2, 9, 30, 2, tzinfo=UTC)

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

_QUEUED: dict[str, Any] = {
    "id": _ID,
    "status": RunStatus.QUEUED,
    "cause": "",
    "label": "crossing-17",
    "batch_id": "",
    "item": 0,
    "town": "tee-town",
    "agent": "idm",
    "seed": None,
    "scenario_sha256": _SHA256,
    "created_at": _POSTED,
    "started_at": None,
    "ended_at": None,
    "cancel_requested": False,
    "attempts": 0,
    "violations": None,
    "at_fault_violations": None,
    "observations": None,
    "accountability": None,
    "steps": None,
    "sim_time_s": None,
    "wall_time_s": None,
    "trace_sha256": "",
}
_FINISHED: dict[str, Any] = {
    **_QUEUED,
    "status": RunStatus.FINISHED,
    "started_at": _STARTED,
    "ended_at": _ENDED,
    "attempts": 1,
    "violations": 1,
    "at_fault_violations": 1,
    "observations": 0,
    "accountability": Accountability.AVOIDABLE,
    "steps": 421,
    "sim_time_s": 21.0,
    "wall_time_s": 0.11,
    "trace_sha256": _SHA256,
}

JOB = jobs.Job(**_QUEUED, run_url=f"/api/v1/runs/{_ID}")
JOBS = PageOf[jobs.JobSummary](items=(jobs.JobSummary(**_FINISHED),), next_page_token="WyJqb2JzIl0")
CANCELLED_JOB = jobs.Job(
    **{**_QUEUED, "status": RunStatus.CANCELLED, "cause": "cancelled", "ended_at": _ENDED},
    error=jobs.Failure(cause="cancelled", message="the run was cancelled"),
    run_url=f"/api/v1/runs/{_ID}",
)

RUN = runs.Run(
    **_FINISHED,
    error=None,
    verdicts=(
        runs.VerdictView(
            oracle="collision",
            ego="ego",
            outcome=Outcome.VIOLATED,
            message="hit npc_1 with its front at 7.4 m/s",
            severity=Severity.CRITICAL,
            at_fault=True,
            undetermined=False,
            avoidable=Answer.YES,
            physically_avoidable=Answer.YES,
            time=20.95,
            step=419,
            location=(120.4, 98.4),
            counterpart="npc_1",
            evidence={"speed": 7.4},
        ),
    ),
    metrics={"route_completion": 0.63},
    scores={"minimum_gap": 0.0, "time_to_collision": None},
    step_cost_us=118.0,
    agent_cost_us={"ego_0": 31.0},
    agents={"ego_0": runs.AgentView(name="idm", parameters={"speed_factor": 1.0})},
    privileged=(),
    versions={"drivora": "0.1.0", "sumo": "1.28.0"},
    tries=(
        runs.Attempt(number=1, worker="slot-0", outcome="finished", cause="", signal="", log=""),
    ),
    observations_url=f"/api/v1/runs/{_ID}/observations",
    scenario_url=f"/api/v1/runs/{_ID}/scenario",
)

BATCH = batches.Batch(
    id=_BATCH_ID,
    name="nightly",
    priority=batches.PriorityName.CI,
    state=BatchState.OPEN,
    created_at=_POSTED,
    size=2,
    done=False,
    counts={RunStatus.FINISHED: 1, RunStatus.QUEUED: 1},
    violated_runs=1,
    jobs_url=f"/api/v1/jobs?batch={_BATCH_ID}",
)
BATCHES = PageOf[batches.Batch](items=(BATCH,))
SUBMISSION = batches.BatchSubmission(
    batch=BATCH,
    accepted=1,
    rejected=1,
    items=(
        batches.BatchItem(item=0, result=batches.ItemResult.ACCEPTED, job_id=_ID),
        batches.BatchItem(
            item=1,
            result=batches.ItemResult.REJECTED,
            problems=(
                ProblemItem(
                    pointer="/map_region/town",
                    code="unknown_town",
                    message="found town 'Town99', which is not in the catalogue",
                ),
            ),
        ),
    ),
)

VALIDATION = service.Validation(
    valid=True, town="tee-town", agents=("idm",), scenario_sha256=_SHA256, notes=()
)
HEALTH = service.Health(status="ok", version="0.1.0")
READINESS = service.Readiness(
    ready=True,
    checks=(
        service.Check(name="database", ok=True, detail=""),
        service.Check(name="traces", ok=True, detail=""),
        service.Check(name="data", ok=True, detail=""),
        service.Check(name="workers", ok=True, detail=""),
        service.Check(name="campaigns", ok=True, detail=""),
        service.Check(name="accepting", ok=True, detail=""),
    ),
)
NOT_READY = service.Readiness(
    ready=False,
    checks=(
        service.Check(name="database", ok=True, detail=""),
        service.Check(name="traces", ok=True, detail=""),
        service.Check(name="data", ok=True, detail=""),
        service.Check(
            name="workers",
            ok=False,
            detail="no worker can be started: libsumo cannot be loaded: libX11.so.6: cannot open "
            "shared object file. Missing on this system: libX11.so.6. Run: apt-get update && "
            "apt-get install --yes --no-install-recommends libx11-6",
        ),
        service.Check(name="campaigns", ok=True, detail=""),
        service.Check(name="accepting", ok=True, detail=""),
    ),
)

_BOUNDS = (0.0, 0.0, 200.0, 200.0)
NETWORKS = catalogues.NetworkList(
    items=(catalogues.NetworkSummary(name="tee-town", url="/api/v1/networks/tee-town"),)
)
NETWORK = catalogues.Network(
    name="tee-town",
    sha256=_SHA256,
    bounds=_BOUNDS,
    net_offset=(0.0, 0.0),
    lanes=212,
    drivable_km=4.2,
    traffic_lights=0,
    has_sidewalks=True,
    geometry_url="/api/v1/networks/tee-town/geometry",
)
GEOMETRY = catalogues.NetworkGeometry(
    name="tee-town",
    sha256=_SHA256,
    bounds=_BOUNDS,
    lanes=(
        catalogues.LaneGeometry(
            id="west_0",
            shape=((0.0, 98.4), (92.0, 98.4)),
            width=3.2,
            drivable=True,
            walkable=False,
            internal=False,
        ),
    ),
    junctions={"centre": ((92.0, 92.0), (108.0, 92.0), (108.0, 108.0), (92.0, 108.0))},
)
AGENTS = catalogues.AgentList(
    items=(
        catalogues.Agent(
            name="idm",
            kind="built-in",
            description="Follows its route with the Intelligent Driver Model",
            source="",
            licence="Apache-2.0",
            version="0.1.0",
            parameters=(
                catalogues.AgentParameter(
                    name="speed_factor",
                    default=1.0,
                    values={"type": "number", "minimum": 0.1, "maximum": 2.0},
                    description="Share of the speed limit that it drives where the road is free.",
                ),
            ),
            privileged=False,
            installed=True,
            reason="",
        ),
    )
)
TESTERS = catalogues.TesterList(
    items=(
        catalogues.Tester(
            name="avfuzzer",
            title="AVFuzzer",
            description="evolves scenarios by a genetic algorithm with restarts",
            source="Li et al., ISSRE 2020",
            generational=True,
            feedback="avfuzzer",
            parameters=(
                catalogues.TesterParameter(
                    name="population",
                    default=4,
                    values={"type": "integer", "minimum": 2},
                    description="Scenarios of a generation (paper: 4).",
                ),
            ),
            installed=True,
            reason="",
        ),
    )
)
ORACLES = catalogues.OracleList(
    items=(
        catalogues.Oracle(
            name="off_road",
            description="The ego leaves the drivable area.",
            thresholds={"tolerance": 0.3},
            package="",
            installed=True,
            reason="",
        ),
    )
)
METRICS_TEXT = "drivora_queue_depth 12.0\n"
FRAME_LINE = (
    '{"step":0,"timestamp":0.0,"egos":[],"other_actors":{"vehicles":[],"walkers":[],'
    '"obstacles":[],"background":[],"traffic_lights":[]},"agent_logs":{}}\n'
)
