"""What decides a result calls no function whose last bits NumPy or BLAS choose by the processor."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import drivora_service
from tests.simulation.other_processor import DISPATCHED

PACKAGE = Path(drivora_service.__file__).parent

ROOMS = (
    "adversaries", "agents", "compilation", "feedback", "geometry", "metrics", "networks",
    "observations", "oracles", "runs", "scenario", "search", "simulation", "worker",
)  # fmt: skip
"""Rooms that decide what happens in a run, how it is judged, or which scenario is next."""

BY_BLAS = (
    "convolve", "corrcoef", "correlate", "cov", "dot", "fft", "inner", "linalg", "matmul",
    "matvec", "outer", "polyfit", "tensordot", "vdot", "vecdot", "vecmat",
)  # fmt: skip

OTHER_NAMES = ("acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "float_power", "pow")
"""Further names of dispatched functions."""

ALLOWED = {
    "agents/adapters": "their planners compute with packages of their own, in their environments",
    "search/selection.py": "products of whole numbers, which are exact",
    "search/space/relations.py": "products of whole numbers, which are exact",
    "search/distance.py": "distances of candidates: equal ones are told from rounding by a slack",
    "search/points.py": "distances of candidates: equal ones are told from rounding by a slack",
    "search/testers/behavexplor/behaviour_model.py": "distances of large tables, by BLAS",
    "search/testers/behavexplor/k_means.py": "distances of large tables, by BLAS",
    "search/testers/samota/screening.py": "correlations of large tables, by BLAS",
    "search/testers/samota/surrogates.py": "linear equations, by LAPACK",
}
"""Modules or folders that may, with the reason. Decision 73 says what follows for campaigns."""


def _calls(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Yields line and name of what NumPy or BLAS dispatch."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            if node.value.id == "np" and node.attr in (*DISPATCHED, *BY_BLAS, *OTHER_NAMES):
                yield node.lineno, f"np.{node.attr}"
        elif isinstance(node, ast.BinOp | ast.AugAssign) and isinstance(node.op, ast.MatMult):
            yield node.lineno, "@"
        elif isinstance(node, ast.ImportFrom) and node.module == "numpy":
            yield from ((node.lineno, f"from numpy import {name.name}") for name in node.names)
        yield from _calls(node)


def _found(text: str) -> list[str]:
    return [name for _, name in _calls(ast.parse(text))]


def test_the_search_finds_what_it_is_for() -> None:
    assert _found("y = np.arctan2(a, b) + np.exp(c)") == ["np.arctan2", "np.exp"]
    assert _found("f = partial(np.log)\nz = a @ b\nz @= c") == ["np.log", "@", "@"]
    assert _found("from numpy import sin") == ["from numpy import sin"]
    assert _found("x = np.linalg.norm(v) + np.hypot(a, b)") == ["np.linalg"]


def test_no_room_that_decides_calls_dispatched_functions() -> None:
    found, excused = [], set()
    for room in ROOMS:
        for path in sorted((PACKAGE / room).rglob("*.py")):
            name = path.relative_to(PACKAGE).as_posix()
            calls = [f"{name}:{line}: {what}" for line, what in _calls(ast.parse(path.read_text()))]
            excuse = next((place for place in ALLOWED if name.startswith(place)), None)
            if excuse is None:
                found += calls
            elif calls:
                excused.add(excuse)
    assert found == []
    assert excused == ALLOWED.keys(), "an exception that nothing needs"
