"""Sessions of Atheris, each in a process of its own, which it ends: ``python -m`` this, by running.

Arguments: inputs, seconds, seed of the draws, bytes of an input (0: as the harness says), folder,
names of harnesses. Instrumenting the product takes longer than a short session, so that it is done
once, and every session is a copy of the process that did it.
"""

from __future__ import annotations

import importlib.metadata
import os
import resource
import sys
import traceback
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import atheris

if TYPE_CHECKING:
    # Imported when it can be instrumented.
    from tests.fuzzing.findings import Session
    from tests.fuzzing.mutation import Mutator

_REPOSITORY = Path(__file__).resolve().parents[2]
_SPARE_BYTES = 1 << 30
"""That inputs may take besides what the process has when it begins."""


def _compiled_modules() -> list[str]:
    """Returns the modules with kernels, whose byte code numba must find as it was."""
    return [
        ".".join(path.relative_to(_REPOSITORY).with_suffix("").parts)
        for path in (_REPOSITORY / "drivora_service").rglob("*.py")
        if "drivora_service.compilation import compiled" in path.read_text(encoding="utf-8")
    ]


def _limit_memory() -> None:
    """Makes excessive allocations raise ``MemoryError``, instead of exhausting the machine."""
    status = Path("/proc/self/status").read_text(encoding="ascii")
    size = next(line for line in status.splitlines() if line.startswith("VmSize:"))
    limit = int(size.split()[1]) * 1024 + _SPARE_BYTES
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))


def main(
    inputs: int, seconds: int, seed: int, max_length: int, folder: Path, names: Sequence[str]
) -> None:
    """Runs the sessions, each in a folder of its own, and writes how their processes ended."""
    # The packages that are installed stay as they are: looking anew for every input is what a
    # session would spend most of its time on.
    importlib.metadata.entry_points = cache(importlib.metadata.entry_points)  # type: ignore[assignment]  # see above
    with atheris.instrument_imports(
        include=["drivora_service", "sumolib"], exclude=_compiled_modules()
    ):
        from tests.fuzzing.findings import Session
        from tests.fuzzing.harnesses import harness_named
        from tests.fuzzing.mutation import Mutator

        harnesses = [harness_named(name) for name in names]
        given = []
        for harness in harnesses:
            longest = max_length or harness.max_length
            given.append({k: data for k, data in harness.seeds().items() if len(data) <= longest})
            for data in given[-1].values():
                # Catalogues, kernels and adapters are made now, outside of all limits.
                harness.parse(data)
    for harness, seeds in zip(harnesses, given, strict=True):
        own = folder / harness.name
        (own / "seeds").mkdir(parents=True, exist_ok=True)
        for seed_name, data in seeds.items():
            (own / "seeds" / seed_name).write_bytes(data)
        options = [
            *(f"-atheris_runs={inputs}", f"-max_total_time={seconds}", f"-seed={seed}"),
            f"-max_len={max_length or harness.max_length}",
        ]
        child = os.fork()
        if child == 0:
            session = Session(harness=harness, folder=own)
            os._exit(_fuzz(session, Mutator(seeds.values(), harness.words), options))
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        (own / "ended").write_text(str(code))


def _fuzz(session: Session, mutator: Mutator, options: Sequence[str]) -> int:
    """Runs a session in this process, and returns its exit code."""
    folder = session.folder
    log = os.open(folder / "session.log", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    for output in (1, 2):
        os.dup2(log, output)

    @atheris.instrument_func  # type: ignore[untyped-decorator]  # Atheris states no types
    def test_one_input(data: bytes) -> None:
        session.run(data)
        # libFuzzer may end the process without what Python does at its end.
        session.write_now_and_then(folder / "counts.json")

    def mutate(data: bytes, max_length: int, number: int) -> bytes:
        if number % 12 == 0:
            changed: bytes = atheris.Mutate(data, max_length)
            return changed
        return mutator.mutate(data, max_length, number)

    atheris.Setup(
        [
            *(sys.argv[0], *options, "-rss_limit_mb=0"),
            # The mutator makes as many changes as are useful.
            "-mutate_depth=2",
            *("-timeout=120", f"-artifact_prefix={folder}/stopped-", str(folder / "seeds")),
        ],
        test_one_input,
        custom_mutator=mutate,
    )
    _limit_memory()
    try:
        atheris.Fuzz()
    except SystemExit as ended:
        session.write(folder / "counts.json")
        return int(ended.code or 0)
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
    return 1


if __name__ == "__main__":
    _inputs, _seconds, _seed, _length = map(int, sys.argv[1:5])
    main(_inputs, _seconds, _seed, _length, Path(sys.argv[5]), sys.argv[6:])
