"""The threads of linear algebra in a process that searches."""

from __future__ import annotations

import json
import os
import subprocess
import sys

from drivora_service.campaigns.records.stored_campaigns import _VARIABLES

_LOOK = """
import json
import numpy
from threadpoolctl import threadpool_info

from drivora_service.campaigns.records.stored_campaigns import use_one_thread

before = [library["num_threads"] for library in threadpool_info()]
use_one_thread()
import scipy.linalg

print(json.dumps([before, [library["num_threads"] for library in threadpool_info()]]))
"""


def test_linear_algebra_has_one_thread_also_in_libraries_that_are_loaded_later() -> None:
    environment = {**os.environ, **dict.fromkeys(_VARIABLES, "2")}
    done = subprocess.run(
        [sys.executable, "-c", _LOOK], env=environment, capture_output=True, text=True, check=True
    )
    before, after = json.loads(done.stdout)
    assert before == [min(2, len(os.sched_getaffinity(0)))]
    # Of NumPy, and of SciPy.
    assert after == [1, 1]
