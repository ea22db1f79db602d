"""What sets two batches apart, in words."""

from __future__ import annotations

from dataclasses import replace

from drivora_service.suites.paired.batch_pairing import compare_runs
from tests.suites.paired.samples import batch, run


def test_an_agent_is_named_with_the_parameters_that_differ_from_its_defaults() -> None:
    plain = run("s", parameters={"gap": 2.0}, configuration="idm", configuration_id="a")
    wider = run("s", parameters={"gap": 2.5}, configuration="idm · gap 2.5", configuration_id="b")
    found = compare_runs(batch([plain], name="old"), batch([wider], name="new"))
    assert (found.a.title, found.b.title) == ("idm", "idm · gap 2.5")
    # A default that was changed is told by no words: both are the ADS as it is by default.
    changed = replace(wider, configuration="idm")
    found = compare_runs(batch([plain], name="old"), batch([changed], name="new"))
    assert (found.a.title, found.b.title) == ("idm with gap 2.0", "idm with gap 2.5")
