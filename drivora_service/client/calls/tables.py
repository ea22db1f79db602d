"""Tables of the results of runs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from drivora_service.api_paths import PREFIX
from drivora_service.client.call import Call, get
from drivora_service.client.calls.jobs import job_query

if TYPE_CHECKING:
    from drivora_service.store.runs.run_records import JobFilter
    from drivora_service.studies.table_names import ResultTableName, TableForm


def result_table(
    table: ResultTableName,
    *,
    batches: Sequence[str] = (),
    campaigns: Sequence[str] = (),
    studies: Sequence[str] = (),
    wanted: JobFilter | None = None,
    columns: Sequence[str] = (),
    form: TableForm | None = None,
) -> Call[bytes]:
    """Returns runs, their verdicts, metrics or agents as a file.

    The runs are those of any of the batches, campaigns and studies; of all if none is named.

    Args:
        table: Which table.
        batches: Ids of batches.
        campaigns: Ids, names, or patterns of names of campaigns.
        studies: Ids of studies.
        wanted: Conditions on a run; its batch and campaign count among the others.
        columns: Names of its columns; empty: all.
        form: As which file; ``None``: Parquet.

    Raises:
        NotFound: One of them does not exist.
    """
    from drivora_service.studies.table_names import TableForm

    query = job_query(wanted)
    return get(
        f"{PREFIX}/tables/{{table}}",
        bytes,
        query={
            **query,
            "batch": (*batches, query["batch"]),
            "campaign": (*campaigns, query["campaign"]),
            "study": tuple(studies),
            "column": tuple(columns),
        },
        accept=form or TableForm.PARQUET,
        table=table,
    )
