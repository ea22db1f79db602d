"""The built-in metrics."""

from __future__ import annotations

from collections.abc import Sequence

from drivora_service.metrics.closed_loop import closed_loop
from drivora_service.metrics.comfort import comfort
from drivora_service.metrics.driving_score import Version, driving_score
from drivora_service.metrics.judgement import Judgement
from drivora_service.metrics.measured import Combine, Measured
from drivora_service.metrics.safety import safety
from drivora_service.metrics.success import success
from drivora_service.metrics.traffic_pace import efficiency
from drivora_service.metrics.travel import travel
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
    scores = {
        version: [driving_score(ego, judgement, version) for ego, judgement in pairs]
        for version in Version
    }
    newest = scores[Version.V2_1]
    return (
        _mean("driving_score", [None if s is None else s.score for s in newest]),
        _mean("route_completion", [None if s is None else s.completion for s in newest]),
        _mean("infraction_penalty", [None if s is None else s.penalty for s in newest]),
        *(
            _mean(
                f"driving_score_{name}", [None if s is None else s.score for s in scores[version]]
            )
            for name, version in (("1_0", Version.V1_0), ("2_0", Version.V2_0))
        ),
        Measured(
            name="success",
            values=tuple(success(judgement) for _, judgement in pairs),
            combine=Combine.LEAST,
        ),
        _mean("comfort", [comfort(ego) for ego in run.egos]),
        _mean("efficiency", [efficiency(ego) for ego in run.egos]),
        *closed_loop(run, judgements),
        *safety(run),
        *travel(run),
    )


def _mean(name: str, values: Sequence[float | None]) -> Measured:
    return Measured(name=name, values=tuple(values), combine=Combine.MEAN)
