"""The built-in metrics."""

from __future__ import annotations

from collections.abc import Sequence

from drivora_service.metrics.closed_loop import measure_closed_loop
from drivora_service.metrics.comfort import comfort
from drivora_service.metrics.driving_score import Version, infraction_penalty
from drivora_service.metrics.infractions import infractions_of
from drivora_service.metrics.judgement import Judgement
from drivora_service.metrics.measured import Combine, Measured
from drivora_service.metrics.route_completion import route_completion
from drivora_service.metrics.safety import measure_safety
from drivora_service.metrics.success import success
from drivora_service.metrics.traffic_pace import efficiency
from drivora_service.metrics.travel import measure_travel
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Trace
from drivora_service.oracles.verdict import Verdict


def measure(
    trace: Trace,
    network: RoadNetwork,
    verdicts: Sequence[Verdict],
    *,
    view: RunView | None = None,
) -> dict[str, float | None]:
    """Measures a judged run.

    Args:
        trace: The run.
        network: The road network it took place on.
        verdicts: Verdicts of the oracles; metrics that need a missing verdict are ``None``.
        view: An existing view of that run, whose computed values are reused.

    Returns:
        Values by name. With several egos, ``name`` is the aggregated value and ``name[ego id]`` the
        value of one ego.
    """
    run = view or RunView(trace, network)
    judgements = tuple(Judgement.of(ego.id, verdicts) for ego in run.egos)
    values: dict[str, float | None] = {}
    for measured in all_measured(run, judgements):
        values[measured.name] = measured.total
        if len(run.egos) > 1:
            for ego, value in zip(run.egos, measured.values, strict=True):
                values[f"{measured.name}[{ego.id}]"] = value
    return values


def all_measured(run: RunView, judgements: tuple[Judgement, ...]) -> tuple[Measured, ...]:
    """Measures every quantity of a run, given the judgement of each ego, in their order."""
    pairs = list(zip(run.egos, judgements, strict=True))
    completions = [route_completion(ego, judgement) for ego, judgement in pairs]
    charged = [infractions_of(ego, judgement) for ego, judgement in pairs]
    penalties = {
        version: [None if one is None else infraction_penalty(one, version) for one in charged]
        for version in Version
    }
    scores = {
        version: [
            None if done is None or penalty is None else done * penalty
            for done, penalty in zip(completions, penalties[version], strict=True)
        ]
        for version in Version
    }
    return (
        _mean("driving_score", scores[Version.V2_1]),
        _mean("route_completion", completions),
        _mean("infraction_penalty", penalties[Version.V2_1]),
        _mean("driving_score_1_0", scores[Version.V1_0]),
        _mean("driving_score_2_0", scores[Version.V2_0]),
        Measured(
            name="success",
            values=tuple(success(judgement) for _, judgement in pairs),
            combine=Combine.LEAST,
        ),
        _mean("comfort", [comfort(ego) for ego in run.egos]),
        _mean("efficiency", [efficiency(ego) for ego in run.egos]),
        *measure_closed_loop(run, judgements),
        *measure_safety(run),
        *measure_travel(run),
    )


def _mean(name: str, values: Sequence[float | None]) -> Measured:
    return Measured(name=name, values=tuple(values), combine=Combine.MEAN)
