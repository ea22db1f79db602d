"""A comparison of two batches as files: Markdown and CSV."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import fields
from pathlib import Path

from drivora_service.studies.tables.csv_text import write_csv
from drivora_service.suites.paired.batch_comparison import (
    BatchComparison,
    FailureComparison,
    MetricComparison,
    PairResult,
    RunResult,
)
from drivora_service.suites.paired.batch_comparison_text import comparison_markdown, failure_rows

_PAIR_COLUMNS = ("scenario", "seed", "town", "fails", "scenario_fails", "same_trace")
_RUN_COLUMNS = ("run", "status", "failures", "sentences")
_LEFT_OUT_COLUMNS = ("reason", "scenario", "seed", "a", "b", "message")


def write_batch_comparison(comparison: BatchComparison, folder: Path) -> tuple[Path, ...]:
    """Writes a comparison into a folder, which is made if it does not exist.

    Returns:
        The files: ``comparison.md``, ``failures.csv``, ``metric-differences.csv``, ``pairs.csv``
        and ``left-out.csv``.
    """
    folder.mkdir(parents=True, exist_ok=True)
    text, failures, metrics, pairs, left_out = (
        folder / name
        for name in (
            "comparison.md",
            "failures.csv",
            "metric-differences.csv",
            "pairs.csv",
            "left-out.csv",
        )
    )
    text.write_text(comparison_markdown(comparison))
    _write_rows(failures, FailureComparison, failure_rows(comparison))
    _write_rows(metrics, MetricComparison, comparison.metrics)
    names = tuple(comparison.pairs[0].a.metrics) if comparison.pairs else ()
    columns = (
        *_PAIR_COLUMNS,
        *(f"{column}_{side}" for column in (*_RUN_COLUMNS, *names) for side in "ab"),
    )
    write_csv(pairs, columns, (_pair_cells(pair, names) for pair in comparison.pairs))
    write_csv(
        left_out,
        _LEFT_OUT_COLUMNS,
        ([getattr(one, name) for name in _LEFT_OUT_COLUMNS] for one in comparison.left_out),
    )
    return text, failures, metrics, pairs, left_out


def _pair_cells(pair: PairResult, metrics: Sequence[str]) -> list[object]:
    cells: list[object] = [getattr(pair, name) for name in _PAIR_COLUMNS]
    cells[-1] = str(pair.same_trace).lower()
    told = [_run_cells(run, metrics) for run in (pair.a, pair.b)]
    return [*cells, *(value for both in zip(*told, strict=True) for value in both)]


def _run_cells(run: RunResult, metrics: Sequence[str]) -> list[object]:
    return [
        run.run,
        str(run.status),
        " ".join(one.oracle for one in run.failures),
        " ".join(one.sentence for one in run.failures),
        *(run.metrics[name] for name in metrics),
    ]


def _write_rows(
    path: Path, kind: type, rows: Iterable[FailureComparison | MetricComparison]
) -> None:
    columns = [field.name for field in fields(kind)]
    write_csv(path, columns, ([getattr(row, name) for name in columns] for row in rows))
