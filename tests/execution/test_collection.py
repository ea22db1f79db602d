from __future__ import annotations

import gc

from drivora_service.serving import settle_garbage_collector


def test_permanent_objects_are_not_traversed_and_many_new_ones_are_awaited() -> None:
    before = gc.get_threshold()
    try:
        settle_garbage_collector()
        assert gc.get_freeze_count() > 0
        assert gc.get_threshold()[0] > 10_000
    finally:
        gc.unfreeze()
        gc.set_threshold(*before)
