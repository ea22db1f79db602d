"""Contradictions found in the store."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """A contradiction.

    Attributes:
        kind: ``damaged_database``, ``lost_runs``, ``missing_report``, ``early_report``,
            ``wrong_count``, ``wrong_facet``, ``missing_trace``, ``damaged_trace`` or
            ``trace_without_run``.
        subject: The id of the run, batch or campaign, the common attributes of the runs of a
            counter, or the path of the file; of the trace of a failure, the campaign's id and the
            file's name.
    """

    kind: str
    subject: str
    message: str
