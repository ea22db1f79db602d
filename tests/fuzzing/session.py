"""One session of Atheris, in a process of its own, which it ends: ``python -m`` this, by __main__.

Arguments: name of the harness, inputs, seconds, seed of the draws, bytes of an input (0: as the
harness says), folder.
"""

from __future__ import annotations

import importlib.metadata
import resource
import sys
from functools import cache
from pathlib import Path

import atheris

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


def main(name: str, inputs: int, seconds: int, seed: int, max_length: int, folder: Path) -> None:
    """Runs the session; does not return."""
    # The packages that are installed stay as they are: looking anew for every input is what a
    # session would spend most of its time on.
    importlib.metadata.entry_points = cache(importlib.metadata.entry_points)  # type: ignore[assignment]  # see above
    with atheris.instrument_imports(
        include=["drivora_service", "sumolib"], exclude=_compiled_modules()
    ):
        from tests.fuzzing.findings import Session
        from tests.fuzzing.harnesses import harness_named
        from tests.fuzzing.mutation import Mutator

        harness = harness_named(name)
        longest = max_length or harness.max_length
        given = {key: data for key, data in harness.seeds().items() if len(data) <= longest}
        for data in given.values():
            # Catalogues, kernels and adapters are made now, outside of all limits.
            harness.parse(data)
    seeds = folder / "seeds"
    seeds.mkdir(exist_ok=True)
    for seed_name, data in given.items():
        (seeds / seed_name).write_bytes(data)
    mutator = Mutator(given.values(), harness.words)
    session = Session(harness=harness, folder=folder)

    @atheris.instrument_func  # type: ignore[untyped-decorator]  # Atheris states no types
    def test_one_input(data: bytes) -> None:
        session.run(data)
        # libFuzzer ends the process without what Python does at its end.
        session.write_now_and_then(folder / "counts.json")

    def mutate(data: bytes, max_length: int, number: int) -> bytes:
        if number % 12 == 0:
            changed: bytes = atheris.Mutate(data, max_length)
            return changed
        return mutator.mutate(data, max_length, number)

    atheris.Setup(
        [
            *(sys.argv[0], f"-atheris_runs={inputs}", f"-max_total_time={seconds}"),
            *(f"-seed={seed}", f"-max_len={longest}", "-rss_limit_mb=0"),
            # The mutator makes as many changes as are useful.
            "-mutate_depth=2",
            *("-timeout=120", f"-artifact_prefix={folder}/stopped-", str(seeds)),
        ],
        test_one_input,
        custom_mutator=mutate,
    )
    _limit_memory()
    atheris.Fuzz()


if __name__ == "__main__":
    _inputs, _seconds, _seed, _length = map(int, sys.argv[2:6])
    main(sys.argv[1], _inputs, _seconds, _seed, _length, Path(sys.argv[6]))
