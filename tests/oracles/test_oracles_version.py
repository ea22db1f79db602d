from __future__ import annotations

from drivora_service.oracles.oracles_version import ORACLES, judged_by_current, oracles_version


def test_the_version_is_the_same_every_time_and_tells_whether_today_s_oracles_judged() -> None:
    first = oracles_version()
    oracles_version.cache_clear()
    assert oracles_version() == first
    assert judged_by_current({"drivora": "0.1.0", ORACLES: first})
    assert not judged_by_current({"drivora": "0.1.0", ORACLES: "0" * len(first)})
    assert not judged_by_current({"drivora": "0.1.0"})
