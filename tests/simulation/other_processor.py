"""A process that computes as on another processor, and what it computes.

NumPy and BLAS choose their code by the processor. In this process each function of which NumPy has
several versions has other last bits, and BLAS is the version for another processor.

As a program, it reads scenarios and genes from its input, and writes what it has computed of them.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import subprocess
import sys
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from drivora_service.compilation import load_compiler

DISPATCHED = (
    *("arccos", "arccosh", "arcsin", "arcsinh", "arctan", "arctan2", "arctanh", "cbrt", "cos"),
    *("cosh", "exp", "exp2", "expm1", "log", "log10", "log1p", "log2", "power", "sin", "sinh"),
    *("tan", "tanh"),
)
"""Functions of which NumPy has a version for processors with AVX2 or AVX-512, of any type, or will
have (sines and cosines of float64)."""


def _perturbed(function: Callable[..., Any]) -> Callable[..., Any]:
    """Returns a function whose finite results are the next greater numbers."""

    def perturbed(*arguments: Any, **options: Any) -> Any:
        found = function(*arguments, **options)
        return np.nextafter(found, np.inf, out=options.get("out"))

    return perturbed


def pretend() -> None:
    """Perturbs NumPy's functions in this process, for good."""
    # The compiler lists NumPy's functions when it is loaded, and would not know the others.
    load_compiler()
    import numba.np.npyimpl  # noqa: F401  # importing it is all that is wanted

    for name in DISPATCHED:
        setattr(np, name, _perturbed(getattr(np, name)))


def probe() -> dict[str, str]:
    """Returns what differs between processors: results of NumPy and of BLAS."""
    values = np.linspace(-3.0, 3.0, 1000)
    table = np.outer(values, np.sin(values)[:50])
    return {
        "numpy": _digest(np.arctan2(values, values[::-1]).tolist()),
        "blas": _digest((table.T @ table).tolist()),
    }


def compute(documents: Mapping[str, Any], scenarios: Mapping[str, str]) -> dict[str, Any]:
    """Returns what must be equal on all processors.

    Args:
        documents: Scenario documents by name: what is read of each is simulated, judged, measured
            and scored, by everything that is built in.
        scenarios: Scenarios in their canonical form, by name; they are simulated.
    """
    from drivora_service.agents.catalogue import AgentCatalogue
    from drivora_service.feedback.catalogue import FeedbackCatalogue
    from drivora_service.feedback.objectives import score
    from drivora_service.metrics.built_in_metrics import measure
    from drivora_service.observations.run_view import RunView
    from drivora_service.observations.trace_files.trace_hash import trace_sha256
    from drivora_service.oracles.built_in import default_oracles, judge_all
    from drivora_service.scenario.canonical import canonical_json, from_canonical
    from drivora_service.scenario.validation import validate_data
    from drivora_service.search.space.space_options import SpaceOptions
    from tests.search.space.seeds import NETWORKS, drawn, space_around
    from tests.simulation.episodes import network, run

    found: dict[str, Any] = {
        name: trace_sha256(run(from_canonical(text))) for name, text in scenarios.items()
    }
    catalogue = FeedbackCatalogue()
    agents = AgentCatalogue()
    for name, document in documents.items():
        read = validate_data(json.dumps(document), NETWORKS, agents.names())
        trace = run(read.scenario)
        road = network(trace.network)
        view = RunView(trace, road)
        verdicts = judge_all(trace, road, default_oracles(), view=view)
        found[name] = {
            "scenario": _digest(canonical_json(read.scenario)),
            "trace": trace_sha256(trace),
            "verdicts": [repr(verdict) for verdict in verdicts],
            "metrics": repr(measure(trace, road, verdicts, view=view)),
            "scores": repr(score(trace, road, view=view)),
            "feedback": {
                feedback: repr(catalogue.plugin(feedback).create({}).measure(view))
                for feedback in catalogue.names()
            },
        }
    options = SpaceOptions(vehicles=4, walkers=2, obstacles=2, lights=True, weather=True)
    for town in ("tee-town", "signal-grid"):
        space = space_around(town, options)
        for number in range(10):
            values = drawn(space, number)
            decoded = canonical_json(space.scenario(values))
            found[f"{town} {number}"] = [_digest(values.tolist()), _digest(decoded)]
    return found


def compute_elsewhere(
    documents: Mapping[str, Any], scenarios: Mapping[str, str]
) -> tuple[dict[str, Any], dict[str, str]]:
    """Returns what a process that pretends computes, and its probe."""
    environment = {**os.environ}
    features = np.show_config(mode="dicts")["SIMD Extensions"].get("found", [])
    if features:
        environment["NPY_DISABLE_CPU_FEATURES"] = " ".join(features)
    if platform.machine() == "x86_64":
        # Without fused operations, and with two numbers in a register.
        environment["OPENBLAS_CORETYPE"] = "Prescott"
    ended = subprocess.run(
        [sys.executable, "-m", __name__],
        input=json.dumps([documents, scenarios]),
        stdout=subprocess.PIPE,
        text=True,
        check=True,
        env=environment,
    )
    found, probed = json.loads(ended.stdout.splitlines()[-1])
    return found, probed


def _digest(values: Any) -> str:
    return hashlib.sha256(json.dumps(values).encode()).hexdigest()[:16]


if __name__ == "__main__":
    pretend()
    print(json.dumps([compute(*json.load(sys.stdin)), probe()]))
