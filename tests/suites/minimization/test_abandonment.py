"""A minimisation that was cancelled, or whose process ends, leaves its own computation."""

from __future__ import annotations

import threading
import time

import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.documents import parse_document
from drivora_service.suites.minimization import abandonment
from drivora_service.suites.minimization.abandonment import Abandoned, AbandonmentCheck
from drivora_service.suites.minimization.proposal_checking import Checker


def check_many(go_on: AbandonmentCheck) -> int:
    """Checks scenarios that differ in their seeds; returns how many until it was abandoned."""
    checker = Checker(NetworkCatalogue(shipped_networks()), AgentCatalogue().availability(), go_on)
    document = parse_document(SCENARIO)
    for checked in range(100_000):
        try:
            checker(document.model_copy(update={"seed": checked}))
        except Abandoned:
            return checked
    pytest.fail("never abandoned")


def test_the_end_of_the_process_is_followed_at_the_next_proposal() -> None:
    stopping = threading.Event()
    threading.Timer(0.3, stopping.set).start()
    begun = time.monotonic()
    assert check_many(AbandonmentCheck(stopping.is_set, lambda: True)) > 0
    assert time.monotonic() - begun < 30.0


def test_a_cancel_is_followed_and_looked_for_now_and_then(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(abandonment, "_LOOK_S", 0.1)
    looks = iter([True, True, False])
    assert check_many(AbandonmentCheck(lambda: False, lambda: next(looks))) > 0
    assert next(looks, None) is None
