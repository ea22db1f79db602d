"""The benchmarks know every testing method, and leave out what is not installed with a reason."""

from __future__ import annotations

from importlib.util import find_spec

from benchmarks.methods import METHODS, installed_methods
from drivora_service.campaigns.document.campaign_catalogues import Catalogues


def test_all_testers_are_known(catalogues: Catalogues) -> None:
    assert sorted(METHODS) == sorted(catalogues.testers.names())


def test_what_is_not_installed_is_left_out_with_a_reason() -> None:
    methods, left_out = installed_methods()
    if find_spec("stable_baselines3") and find_spec("torch") and find_spec("gymnasium"):
        assert (methods, left_out) == (METHODS, ())
    else:
        assert set(METHODS) - set(methods) == {"deepcollision"}
        assert len(left_out) == 1
        assert "stable_baselines3" in left_out[0]
    assert installed_methods(["samota"]) == (("samota",), ())
