"""The shipped smoke suite: what it holds, and that it tells ADSs apart."""

from __future__ import annotations

import shutil
from collections import Counter
from pathlib import Path
from statistics import median

import pytest

from drivora_service.cli.suites.suite_files import (
    names_of_installation,
    read_suite_path,
    shipped_suites,
)
from drivora_service.errors import ConfigurationError
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.oracles.catalogue import OracleCatalogue
from drivora_service.suites.gate.baseline_files import read_baseline
from drivora_service.suites.suite import Suite

FOLDER = shipped_suites() / "smoke"


@pytest.fixture(scope="module")
def smoke() -> Suite:
    return read_suite_path(Path("smoke"), names_of_installation())


def test_it_has_a_hundred_scenarios_on_all_networks(smoke: Suite) -> None:
    assert len(smoke.scenarios) == 100
    towns = Counter(one.document.map_region.town for one in smoke.scenarios)
    assert set(towns) == {path.name for path in shipped_networks().iterdir() if path.is_dir()}
    assert min(towns.values()) >= 5
    assert max(towns.values()) <= 30
    hashes = {one.document.model_dump_json(exclude={"extensions"}) for one in smoke.scenarios}
    assert len(hashes) == 100


def test_the_same_ads_drives_all_unless_another_is_named(smoke: Suite) -> None:
    agents = {ego.agent_name for one in smoke.scenarios for ego in one.document.ego_vehicles}
    assert agents == {"idm"}


def test_the_difficulty_of_each_is_known(smoke: Suite) -> None:
    panels = set()
    for one in smoke.scenarios:
        assert one.difficulty is not None
        assert one.difficulty.passed_by, f"all fail in {one.name}, which tells nothing"
        assert not set(one.difficulty.failed_by) & set(one.difficulty.passed_by)
        panels.add(frozenset((*one.difficulty.failed_by, *one.difficulty.passed_by)))
    assert len(panels) == 1, "the same ADSs have driven all"
    (panel,) = panels
    assert len(panel) == 8
    failing = Counter(len(one.difficulty.failed_by) for one in smoke.scenarios if one.difficulty)
    assert max(failing.values()) <= 40, "of all difficulties"
    for ads in panel:
        fails = sum(ads in one.difficulty.failed_by for one in smoke.scenarios if one.difficulty)
        assert 10 <= fails <= 90, f"{ads} fails in {fails} of 100"


def test_tags_name_the_network_and_the_violated_oracles(smoke: Suite) -> None:
    oracles = set(OracleCatalogue().names())
    for one in smoke.scenarios:
        assert "smoke" in one.tags
        assert one.document.map_region.town in one.tags
        assert oracles & set(one.tags)


def test_the_baseline_of_idm_is_what_the_difficulty_says(smoke: Suite) -> None:
    baseline = read_baseline(FOLDER / "idm.baseline.json")
    assert (baseline.suite, baseline.agent) == (smoke.name, "idm")
    assert baseline.scenarios.keys() == smoke.by_name.keys()
    always, sometimes = set(), set()
    for name, one in baseline.scenarios.items():
        assert len(one.seeds) == 10
        for failure in one.failures:
            sometimes.add(name)
            if failure.runs == len(one.seeds):
                always.add(name)
    fails = {
        one.name
        for one in smoke.scenarios
        if one.difficulty is not None and "idm" in one.difficulty.failed_by
    }
    assert always <= fails <= sometimes


def test_its_page_has_the_figures_of_its_scenarios(smoke: Suite) -> None:
    page = (FOLDER / "README.md").read_text()
    towns = Counter(one.document.map_region.town for one in smoke.scenarios)
    failing: Counter[str] = Counter()
    numbers: Counter[int] = Counter()
    for one in smoke.scenarios:
        assert one.difficulty is not None
        failing.update(one.difficulty.failed_by)
        numbers[len(one.difficulty.failed_by)] += 1
    oracles = Counter(tag for one in smoke.scenarios for tag in one.tags)
    for name, count in (*towns.items(), *failing.items()):
        assert f"| `{name}` | {count} |" in page
    for name in OracleCatalogue().names():
        assert (f"| `{name}` | {oracles[name]} |" in page) == (name in oracles)
    assert "| scenarios | " + " | ".join(f"{numbers[n]}" for n in range(8)) + " |" in page


def test_its_name_is_one_of_the_shipped_suites(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    known = names_of_installation()
    with pytest.raises(ConfigurationError, match=r"did you mean 'smoke'\? Shipped: smoke"):
        read_suite_path(Path("smok"), known)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "smoke").mkdir()
    shutil.copy(next((FOLDER / "scenarios").glob("*.json")), tmp_path / "smoke")
    assert len(read_suite_path(Path("smoke"), known).scenarios) == 1


def test_its_files_are_small() -> None:
    sizes = [path.stat().st_size for path in (FOLDER / "scenarios").glob("*.json")]
    assert median(sizes) < 3_000
    assert max(sizes) < 30_000
