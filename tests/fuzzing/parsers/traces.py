"""Trace files: Parquet, with a header as JSON.

An input is a whole file, or a header that is put into an intact file.
"""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from functools import cache

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from drivora_service.errors import StoreError
from drivora_service.observations.trace import Contact
from drivora_service.observations.trace_files.trace_file import read_steps, read_trace, write_trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace
from tests.fuzzing.harness import Harness, by_name, check_refusal
from tests.fuzzing.parsers.shared import folder

_KEY = b"drivora_trace"


@cache
def _table() -> pa.Table:
    k = np.arange(6)
    trace = make_trace(
        [SyntheticEgo(motion=Motion.along(0.4 * k, 0.0 * k), logs={"gap": 0.5 * k})],
        [SyntheticActor(motion=Motion.steady(9.0, 0.0, steps=6, speed=1.0), present=k > 2)],
        contacts=[Contact(step=4, ego=0, other=1)],
        lights={"j": ["Gr", "Gr", "rG", "rG", "rG", "rG"]},
    )
    path = folder() / "seed.parquet"
    write_trace(trace, path)
    return pq.read_table(path)


def _parse(data: bytes) -> bool:
    path = folder() / "run.parquet"
    if data.startswith(b"PAR1"):
        path.write_bytes(data)
    else:
        pq.write_table(_table().replace_schema_metadata({_KEY: data}), path)
    try:
        trace = read_trace(path)
        read_steps(path, 1, 3)
    except StoreError as error:
        check_refusal(error)
        return False
    trace_sha256(trace)
    return True


def _seeds() -> Mapping[str, bytes]:
    whole = io.BytesIO()
    pq.write_table(_table(), whole, compression="none")
    header = json.dumps(json.loads(_table().schema.metadata[_KEY]))
    return {"header": header.encode(), "file": whole.getvalue()}


TRACE = Harness(name="trace", parse=_parse, seeds=_seeds, max_length=32_768)
HARNESSES = by_name(TRACE)
