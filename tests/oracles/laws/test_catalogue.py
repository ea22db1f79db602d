"""Laws in the catalogue of oracles: shipped ones, the user's, and files that cannot be used."""

from __future__ import annotations

import pytest

from drivora_service.errors import OracleError
from drivora_service.oracles.built_in import judge_all
from drivora_service.oracles.catalogue import OracleCatalogue
from drivora_service.oracles.laws.sources import LawSource
from drivora_service.oracles.verdict import Outcome
from drivora_service.testing.traces import Motion, make_trace
from tests.oracles.judging import ROAD, on_lane
from tests.oracles.laws.laws import source_of

BROKEN = LawSource(file="wrong.yaml", data=source_of("sped < 3").data)


def test_a_law_of_the_user_is_an_oracle() -> None:
    catalogue = OracleCatalogue([source_of("speed < 3")])
    assert catalogue.names()[-1] == "own_law"
    entry = catalogue.entry("own_law")
    assert (entry.formula, entry.file, entry.package, entry.reason) == (
        "always (speed < 3)",
        "own.yaml",
        "",
        "",
    )
    told = catalogue.description("own_law")
    assert told is not None
    assert told.definition == entry.description == "It is violated."
    trace = make_trace([on_lane(motion=Motion.steady(0.0, 0.0, steps=50, speed=9.0))])
    verdict = judge_all(trace, ROAD, catalogue.oracles())[-1]
    assert (verdict.oracle, verdict.outcome) == ("own_law", Outcome.VIOLATED)


def test_a_shipped_law_describes_itself_with_its_parameters() -> None:
    catalogue = OracleCatalogue()
    entry = catalogue.entry("law_45_speed_limit")
    assert dict(entry.thresholds) == {"excess": 0.05, "patience": 3.0}
    assert (entry.file, entry.package) == ("", "")
    told = catalogue.description("law_45_speed_limit")
    assert told is not None
    assert [(one.name, one.unit) for one in told.thresholds] == [("excess", "1"), ("patience", "s")]
    assert "article 45" in told.source


def test_only_a_file_of_the_user_has_a_version() -> None:
    catalogue = OracleCatalogue([source_of("speed < 3")])
    (version,) = catalogue.versions("own_law").items()
    assert version[0] == "laws/own.yaml"
    assert len(version[1]) == 16
    other = OracleCatalogue([source_of("speed < 4")]).versions("own_law")
    assert dict(other) != dict([version])
    assert catalogue.versions("law_45_speed_limit") == {}


def test_a_file_that_cannot_be_used_is_listed_with_its_reason_and_no_run_is_judged() -> None:
    catalogue = OracleCatalogue([source_of("speed < 3"), BROKEN])
    entry = catalogue.entry("wrong.yaml")
    assert "wrong.yaml:7:22: unknown name 'sped'; did you mean 'speed'?" in entry.reason
    assert entry.file == "wrong.yaml"
    for judge in (catalogue.laws, catalogue.oracles, lambda: catalogue.oracle("wrong.yaml")):
        with pytest.raises(OracleError, match=r"law file 'wrong\.yaml'.*unknown name") as told:
            judge()
        assert told.value.cause == "law_file"
    # The others can still be named and shown.
    assert catalogue.oracle("own_law").name == "own_law"


@pytest.mark.parametrize("name", ["collision", "law_45_speed_limit", "own_law"])
def test_a_law_replaces_no_oracle(name: str) -> None:
    sources = [source_of("speed < 3"), source_of("speed < 1", name=name, file="other.yaml")]
    catalogue = OracleCatalogue(sources)
    assert f"there is an oracle {name!r} already" in catalogue.entry("other.yaml").reason
    assert dict(catalogue.versions("own_law"))
