from __future__ import annotations

import asyncio
import gc
import weakref

from drivora_service.serving import collect_garbage, settle_garbage_collector


def test_permanent_objects_are_not_traversed_and_many_new_ones_are_awaited() -> None:
    before = gc.get_threshold()
    try:
        settle_garbage_collector()
        assert gc.get_freeze_count() > 0
        assert gc.get_threshold()[0] > 10_000
    finally:
        gc.unfreeze()
        gc.set_threshold(*before)


class _Node:
    def __init__(self) -> None:
        self.itself = self


def test_unreachable_objects_are_freed_again_and_again_while_the_loop_runs() -> None:
    freed = []

    async def leave_garbage() -> None:
        collect_garbage(asyncio.get_running_loop(), every_s=0.01)
        for _ in range(2):
            node = weakref.ref(_Node())
            assert node() is not None
            async with asyncio.timeout(5.0):
                while node() is not None:
                    await asyncio.sleep(0.01)
            freed.append(node)

    before = gc.get_threshold()
    try:
        gc.set_threshold(1_000_000)
        asyncio.run(leave_garbage())
    finally:
        gc.set_threshold(*before)
    assert len(freed) == 2
