"""The series of an ego as JSON or Arrow."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivora_service.api.schemas.series import Series, SeriesColumnHead, SeriesHead
from drivora_service.metrics.ego_series import COLUMNS, ego_series
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace_files.table_stream import TableStream, one_batch

_METADATA = "drivora_series"


def series_json(run_id: str, ego: EgoView) -> bytes:
    """Returns the series of an ego as JSON."""
    values = {name: _plain(column) for name, column in ego_series(ego).items()}
    head = _head(run_id, ego)
    series = Series(**head.model_dump(), values=values)
    return series.model_dump_json().encode()


def series_table(run_id: str, ego: EgoView) -> TableStream:
    """Returns the series of an ego as an Arrow stream."""
    return one_batch(ego_series(ego), {_METADATA: _head(run_id, ego).model_dump_json()})


def _head(run_id: str, ego: EgoView) -> SeriesHead:
    lanes: Mapping[int, str] = {
        index: ego.network.lanes[index].id for index in np.unique(ego.lanes).tolist() if index >= 0
    }
    return SeriesHead(
        run_id=run_id,
        ego=ego.id,
        row=ego.row,
        lanes=dict(lanes),
        actors=tuple(actor.id for actor in ego.trace.actors),
        columns=tuple(
            SeriesColumnHead(name=one.name, unit=one.unit, description=one.description)
            for one in COLUMNS
        ),
    )


def _plain(values: NDArray[Any]) -> tuple[int | float | None, ...]:
    """Returns values with ``None`` for NaN, rounded to micrometres and their like."""
    if not np.issubdtype(values.dtype, np.floating):
        return tuple(values.tolist())
    return tuple(None if value != value else round(value, 6) for value in values.tolist())
