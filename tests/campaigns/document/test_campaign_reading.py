from __future__ import annotations

import copy
import json
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import pytest
import yaml

from drivora_service.campaigns.document import campaign_documents
from drivora_service.campaigns.document.campaign import FeedbackMode
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_documents import SpaceDocument, campaign_text
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.search.search_preparation import prepare_search
from drivora_service.errors import InvalidDocument
from drivora_service.oracles.catalogue import OracleCatalogue
from drivora_service.oracles.verdicts.failure_definition import DEFAULT_DEFINITION
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.search.space.presets import PRESETS, SpacePreset
from drivora_service.search.space.space_options import SpaceOptions
from tests.oracles.installing import install_oracles
from tests.oracles.laws.laws import source_of

Change = Callable[[dict[str, Any]], object]


def put(*path: str | int, value: Any) -> Change:
    """A change that sets the value at a path."""

    def change(content: dict[str, Any]) -> None:
        place: Any = content
        for key in path[:-1]:
            place = place.setdefault(key, {}) if isinstance(place, dict) else place[key]
        place[path[-1]] = value

    return change


def drop(key: str) -> Change:
    return lambda content: content.pop(key)


def several(*names: str, keep: bool = False, change: Change = lambda _: None) -> Change:
    """A change that gives several seed scenarios, and changes the second."""

    def apply(content: dict[str, Any]) -> None:
        scenario = content["scenario"] if keep else content.pop("scenario")
        content["scenarios"] = [
            {"name": name, "scenario": copy.deepcopy(scenario)} for name in names
        ]
        if len(names) > 1:
            change(content["scenarios"][1]["scenario"])

    return apply


EGO_MODEL = ("scenario", "ego_vehicles", 0, "model")
WRONG: dict[str, tuple[Change, str, str]] = {
    "no name": (drop("name"), "/name", "missing"),
    "empty name": (put("name", value=""), "/name", "at least 1"),
    "no tester": (drop("tester"), "/tester", "missing"),
    "no budget": (drop("budget"), "/budget", "missing"),
    "no scenario": (drop("scenario"), "/scenarios", "neither of `scenario` and `scenarios`"),
    "one scenario and several": (several("a", keep=True), "/scenarios", "both of `scenario`"),
    "scenarios of one name": (several("a", "b", "a"), "/scenarios", "the name 'a' more than once"),
    "no scenarios": (several(), "/scenarios", "neither of `scenario`"),
    "a scenario among several": (
        several("a", "b", change=put("ego_vehicles", 0, "model", value="tank")),
        "/scenarios/1/scenario/ego_vehicles/0/model",
        "tank",
    ),
    "a file among several": (
        several("a", "b", change=put("file", value="x.json")),
        "/scenarios/1/scenario/file",
        "only the command line reads files",
    ),
    "unknown key": (put("bugdet", value=1), "/bugdet", "did you mean 'budget'"),
    "unknown tester": (put("tester", "name", value="randon"), "/tester/name", "'random'"),
    "tester as text": (put("tester", value="random"), "/tester", "an object"),
    "tester's parameters": (
        put("tester", "parameters", value={"population": 4}),
        "/tester/parameters/population",
        "no parameter 'population'",
    ),
    "a tester's parameter beyond the budget": (
        put("tester", value={"name": "avfuzzer", "parameters": {"population": 5000}}),
        "/tester/parameters/population",
        "population is 5000; allowed: an integer from 2 to ",
    ),
    "a tester's parameter beyond all budgets": (
        put("tester", value={"name": "samota", "parameters": {"initial": 10**9}}),
        "/tester/parameters/initial",
        "initial is 1000000000; allowed: an integer from 1 to 30 (the default; ",
    ),
    "unknown mutation": (put("tester", "mutation", value="gauss"), "/tester/mutation", "nown:"),
    "unknown selection": (put("tester", "selection", value="best"), "/tester/selection", "nown:"),
    "unknown preset": (
        put("space", value={"preset": "avfuzzr"}),
        "/space/preset",
        "'default', 'avfuzzer', 'behavexplor' or 'doppeltest'",
    ),
    "preset as a list": (put("space", value={"preset": ["avfuzzer"]}), "/space/preset", "found"),
    "unknown option of a preset": (
        put("space", value={"preset": "avfuzzer", "vehicle": 3}),
        "/space/vehicle",
        "did you mean 'vehicles'",
    ),
    "too hard braking": (
        put("space", value={"max_deceleration": 12.5}),
        "/space/max_deceleration",
        "12",
    ),
    "too gentle braking": (
        put("space", value={"max_deceleration": 0.25}),
        "/space/max_deceleration",
        "0 and 0.5 or more are allowed",
    ),
    "unknown feedback": (
        put("tester", "feedback", value="none"),
        "/tester/feedback",
        "'own' or 'shuffled'",
    ),
    "unknown agent": (put("agent", "name", value="idn"), "/agent/name", "'idm'"),
    "agent's parameters": (
        put("agent", "parameters", value={"speed_factor": 3}),
        "/agent/parameters/speed_factor",
        "a number from 0.1 to 2",
    ),
    "parameters of an agent in the scenario": (
        put("scenario", "ego_vehicles", 0, "agent", value={"name": "idm", "parameters": {"a": 1}}),
        "/scenario/ego_vehicles/0/agent/parameters/a",
        "known: speed_factor",
    ),
    "unknown oracle": (
        put("oracles", value=["collision", "crash"]),
        "/oracles/1",
        "unknown oracle 'crash'; known: collision",
    ),
    "misspelt oracle": (put("oracles", value=["red_lihgt"]), "/oracles/0", "mean 'red_light'"),
    "oracle as number": (put("oracles", value=["collision", 3]), "/oracles/1", "text"),
    "no oracle": (put("oracles", value=[]), "/oracles", "at least 1"),
    "oracle twice": (put("oracles", value=["blocked", "blocked"]), "/oracles", "more than once"),
    "no simulations": (put("budget", "simulations", value=0), "/budget/simulations", "found 0"),
    "simulations as text": (
        put("budget", "simulations", value="300"),
        "/budget/simulations",
        "an integer",
    ),
    "budget in seconds": (put("budget", "seconds", value=3600), "/budget/seconds", "unknown"),
    "negative seed": (put("seed", value=-1), "/seed", "found -1"),
    "half a worker": (put("workers", value=1.5), "/workers", "1.5"),
    "no lookahead": (put("lookahead", value=0), "/lookahead", "found 0"),
    "unknown option": (put("space", "cars", value=3), "/space/cars", "unknown"),
    "too many vehicles": (put("space", "vehicles", value=1000), "/space/vehicles", "found 1000"),
    "weather in words": (put("space", "weather", value="yes"), "/space/weather", "boolean"),
    "other version": (put("version", value="2.0"), "/version", "'1.0'"),
    "scenario of another town": (
        put("scenario", "map_region", "town", value="no-town"),
        "/scenario/map_region/town",
        "no-town",
    ),
    "unknown model": (
        put(*EGO_MODEL, value="vehicle.tank"),
        "/" + "/".join(map(str, EGO_MODEL)),
        "",
    ),
    "scenario in a file": (put("scenario", value={"file": "x.json"}), "/scenario/file", "itself"),
    "NaN": (put("space", "reach", value=float("nan")), "/space/reach", "finite"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_mistake_is_named_with_its_place(
    name: str, content: dict[str, Any], catalogues: Catalogues
) -> None:
    change, pointer, said = WRONG[name]
    change(content)
    with pytest.raises(InvalidDocument) as caught:
        read_campaign(content, catalogues)
    assert [problem.pointer for problem in caught.value.problems] == [pointer]
    assert said in caught.value.problems[0].message


def test_all_mistakes_are_named_at_once_and_in_order(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    for name in ("unknown tester", "unknown agent", "unknown model", "no oracle", "negative seed"):
        WRONG[name][0](content)
    with pytest.raises(InvalidDocument) as caught:
        read_campaign(content, catalogues)
    assert [problem.pointer for problem in caught.value.problems] == [
        "/tester/name",
        "/agent/name",
        "/scenario/ego_vehicles/0/model",
        "/oracles",
        "/seed",
    ]


def test_a_campaign_may_name_an_installed_oracle_that_can_judge(
    content: dict[str, Any],
    catalogues: Catalogues,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    install_oracles(tmp_path, monkeypatch, "top_speed", "unmade")
    here = Catalogues(catalogues.networks)
    here.oracles = OracleCatalogue()
    content["oracles"] = ["collision", "top_speed"]
    assert read_campaign(content, here).campaign.definition.oracles == ("collision", "top_speed")
    content["oracles"] = ["top_sped", "unmade"]
    with pytest.raises(InvalidDocument) as caught:
        read_campaign(content, here)
    unknown, broken = caught.value.problems
    assert (unknown.pointer, broken.pointer) == ("/oracles/0", "/oracles/1")
    assert "did you mean 'top_speed'? Known: collision" in unknown.message
    assert "of the package 'foreign-oracles' raised RuntimeError" in broken.message


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("- 1", "a campaign is one object"),
        ("name: &x a\nseed: *x", "anchor"),
        ("name: !!python/object/apply:os.system [ls]", "not YAML"),
        ("name: a\nname: b", "more than once"),
        ("{", "not YAML"),
    ],
)
def test_yaml_is_read_safely(text: str, said: str, catalogues: Catalogues) -> None:
    with pytest.raises(InvalidDocument, match=said):
        read_campaign(text, catalogues, "yaml")


def test_yaml_and_json_mean_the_same(content: dict[str, Any], catalogues: Catalogues) -> None:
    from_json = read_campaign(json.dumps(content), catalogues)
    from_yaml = read_campaign(yaml.safe_dump(content), catalogues, "yaml")
    assert from_json.campaign == from_yaml.campaign
    assert from_json.seeds == from_yaml.seeds


def test_a_campaign_is_read_back_as_it_was_written(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    content["tester"]["feedback"] = "shuffled"
    content["workers"] = 2
    first = read_campaign(content, catalogues)
    again = read_campaign(campaign_text(first.document), catalogues)
    assert (again.campaign, again.seeds) == (first.campaign, first.seeds)
    assert again.campaign.tester.feedback is FeedbackMode.SHUFFLED


def test_little_has_to_be_said(content: dict[str, Any], catalogues: Catalogues) -> None:
    least = {key: content[key] for key in ("name", "tester", "scenario", "budget")}
    campaign = read_campaign(least, catalogues).campaign
    assert campaign.definition == DEFAULT_DEFINITION
    assert campaign.space == SpaceOptions()
    assert (campaign.lookahead, campaign.workers, campaign.agent) == (8, None, None)


def test_workers_that_would_be_idle_are_told_of(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    content["lookahead"] = 4
    valid = read_campaign(content, catalogues)
    assert valid.notes_for(None) == valid.notes_for(4) == valid.notes
    (*_, note) = valid.notes_for(5)
    assert "at most 4 of 5 workers" in note


def test_the_campaigns_agent_overrides_that_of_the_scenario(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    (ego,) = content["scenario"]["ego_vehicles"]
    ego["agent"] = {"name": "driver-of-last-year"}
    assert read_campaign(content, catalogues).seeds[0].scenario.ego_vehicles[0].agent.name == "idm"
    del ego["agent"]
    assert read_campaign(content, catalogues).notes == ()
    del content["agent"]
    (note,) = read_campaign(content, catalogues).notes
    assert "names no agent" in note


def test_the_agent_drives_every_ego(content: dict[str, Any], catalogues: Catalogues) -> None:
    content["agent"] = {"name": "idm", "parameters": {"speed_factor": 0.5}}
    second = copy.deepcopy(content["scenario"]["ego_vehicles"][0])
    second |= {"id": "ego_1", "agent": {"name": "sumo-krauss"}, "start_time": 10.0}
    second["route"] = [{"x": 3.01, "y": 104.32, "yaw": 91.51}, {"x": 2.2, "y": 140.0, "yaw": 91.0}]
    content["scenario"]["ego_vehicles"].append(second)
    seed = read_campaign(content, catalogues).seeds[0].scenario
    assert [ego.agent.name for ego in seed.ego_vehicles] == ["idm", "idm"]
    assert all(ego.agent.parameters == {"speed_factor": 0.5} for ego in seed.ego_vehicles)


def test_documents_have_the_options_of_the_space() -> None:
    options = {field.name for field in fields(SpaceOptions)}
    assert set(SpaceDocument.model_fields) == {"name", "parameters", "preset", *options}
    defaults = SpaceDocument()
    for field in fields(SpaceOptions):
        assert getattr(defaults, field.name) == getattr(SpaceOptions(), field.name)


@pytest.mark.parametrize("name", SpacePreset)
def test_a_preset_fills_the_space(
    name: SpacePreset, content: dict[str, Any], catalogues: Catalogues
) -> None:
    content["space"] = {"preset": name.value}
    valid = read_campaign(content, catalogues)
    assert valid.campaign.space == PRESETS[name].options
    (note,) = valid.notes
    assert f"the preset {name.value!r}: {PRESETS[name].description}" in note
    assert "changed" not in note


def test_values_of_a_preset_can_be_replaced(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    # `null` is as little a value here as elsewhere; 0 is one.
    own = {"vehicles": 3, "slice_time": 2.0, "min_speed": None, "max_deceleration": 0.0}
    content["space"] = {"preset": "avfuzzer", **own}
    valid = read_campaign(content, catalogues)
    given = PRESETS[SpacePreset.AVFUZZER].options
    assert valid.campaign.space == replace(given, vehicles=3, slice_time=2.0, max_deceleration=0.0)
    assert valid.notes[0].endswith("; changed in the file: vehicles, slice_time, max_deceleration")
    # What is stored has all values, and is read to the same.
    stored = campaign_text(valid.document)
    assert read_campaign(stored, catalogues).campaign == valid.campaign


def test_a_stored_space_does_not_follow_its_preset(
    content: dict[str, Any], catalogues: Catalogues, monkeypatch: pytest.MonkeyPatch
) -> None:
    content["space"] = {"preset": "behavexplor"}
    valid = read_campaign(content, catalogues)
    stored = campaign_text(valid.document)
    later = replace(
        PRESETS[SpacePreset.BEHAVEXPLOR], options=SpaceOptions(vehicles=9, slice_time=2.0)
    )
    monkeypatch.setattr(campaign_documents, "PRESETS", {**PRESETS, SpacePreset.BEHAVEXPLOR: later})
    assert read_campaign(stored, catalogues).campaign.space == valid.campaign.space
    space = read_campaign(content, catalogues).campaign.space
    assert isinstance(space, SpaceOptions)
    assert space.vehicles == 9


def test_a_space_that_cannot_be_is_a_problem_of_the_space(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    content["space"] = {"vehicles": 0, "walkers": 0, "weather": False}
    valid = read_campaign(content, catalogues)
    with pytest.raises(InvalidDocument) as caught:
        prepare_search(valid, catalogues, run_prefix="x")
    assert [problem.pointer for problem in caught.value.problems] == ["/space"]


def test_a_search_is_the_same_each_time(content: dict[str, Any], catalogues: Catalogues) -> None:
    def candidates() -> list[str]:
        valid = read_campaign(content, catalogues)
        search = prepare_search(valid, catalogues, run_prefix="x")
        (part,) = search.parts
        return [part.candidates.prepare(p.values).document for p in part.tester.ask(3)]

    first = candidates()
    assert first == candidates()
    assert len(set(first)) == 3
    assert '"name":"idm"' in first[0]


def test_several_seed_scenarios_have_parts_of_their_own(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    alone = prepare_search(read_campaign(content, catalogues), catalogues, run_prefix="x")
    later = put("max_sim_time", value=7.5)
    several("first", "second", change=later)(content)
    valid = read_campaign(content, catalogues)
    assert [seed.name for seed in valid.seeds] == ["first", "second"]
    assert valid.town == "tee-town"
    assert read_campaign(campaign_text(valid.document), catalogues).seeds == valid.seeds
    search = prepare_search(valid, catalogues, run_prefix="x")
    first, second = search.parts
    (only,) = alone.parts
    assert first.candidates.source == only.candidates.source
    assert '"max_sim_time":7.5' in second.candidates.source.seed
    mine, others, its = (part.tester.ask(2) for part in (first, second, only))
    # The first draws what it would draw alone, the second something else.
    assert [p.values.tolist() for p in mine] == [p.values.tolist() for p in its]
    assert [p.values.tolist() for p in mine] != [p.values.tolist() for p in others]


def test_the_networks_of_several_seed_scenarios_are_named_together(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    alone = read_campaign(content, catalogues).network_sha256
    (seed,) = generate_seeds(
        catalogues.networks.get("old-town"),
        count=1,
        min_length=50.0,
        max_length=400.0,
        seed=1,
        agent="idm",
    )
    several("here", "there")(content)
    assert read_campaign(content, catalogues).network_sha256 == alone
    content["scenarios"][1]["scenario"] = json.loads(document_text(seed))
    valid = read_campaign(content, catalogues)
    assert valid.town == "tee-town, old-town"
    assert valid.network_sha256 != alone


def test_oracles_that_a_tester_needs_or_that_have_nothing_to_judge_are_told_of(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    content["oracles"] = ["collision", "non_optimal_decision"]
    (note,) = read_campaign(content, catalogues).notes
    assert "judges nothing here" in note
    content["tester"] = {"name": "decictor"}
    assert read_campaign(content, catalogues).notes == ()
    content["oracles"] = ["collision"]
    (note,) = read_campaign(content, catalogues).notes
    assert "name it in `oracles`" in note
    content["tester"] = {"name": "random"}
    content["oracles"] = ["non_optimal_decision"]
    (ego,) = content["scenario"]["ego_vehicles"]
    ego["reference_path"] = [
        {"time": time, "x": 10.0 * time, "y": 0.0, "yaw": 0.0, "speed": 10.0} for time in (0.0, 9.0)
    ]
    assert read_campaign(content, catalogues).notes == ()


def test_paths_cannot_be_kept_clear_of_vehicles_that_sumo_drives(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    content["tester"] = {"name": "decictor"}
    content["space"] |= {"optional": True, "behavior": "sumo"}
    with pytest.raises(InvalidDocument) as refused:
        prepare_search(read_campaign(content, catalogues), catalogues, run_prefix="x")
    (problem,) = refused.value.problems
    assert problem.pointer == "/space/behavior"
    assert "'replay' or 'reactive'" in problem.message


def test_a_law_that_is_searched_for_must_exist(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    content["tester"] = {
        "name": "lawbreaker",
        "parameters": {"laws": ["law_45_speed_limit", "law_45_speed"]},
    }
    with pytest.raises(InvalidDocument) as refused:
        read_campaign(content, catalogues)
    (problem,) = refused.value.problems
    assert problem.pointer == "/tester/parameters/laws/1"
    assert "unknown law 'law_45_speed'; did you mean 'law_45_speed_limit'" in problem.message
    content["tester"]["parameters"] = {"laws": ["law_45_speed_limit"]}
    assert read_campaign(content, catalogues).campaign.tester.name == "lawbreaker"


def test_a_search_by_laws_depends_on_the_users_files(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    own = Catalogues(catalogues.networks, laws=(source_of("speed < 3"),))
    assert "laws/own.yaml" not in read_campaign(content, own).versions
    content["oracles"] = ["collision", "own_law"]
    assert "laws/own.yaml" in read_campaign(content, own).versions
    content["oracles"] = ["collision"]
    content["tester"] = {"name": "lawbreaker"}
    assert "laws/own.yaml" in read_campaign(content, own).versions
    changed = Catalogues(catalogues.networks, laws=(source_of("speed < 4"),))
    assert read_campaign(content, own).versions != read_campaign(content, changed).versions


def test_a_stored_campaign_is_not_compared_with_its_budget(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    content["tester"] = {"name": "avfuzzer", "parameters": {"population": 5000}}
    with pytest.raises(InvalidDocument, match="population is 5000"):
        read_campaign(content, catalogues)
    stored = read_campaign(content, catalogues, is_stored=True)
    assert stored.campaign.tester.parameters == {"population": 5000}


def test_several_seed_scenarios_share_the_budget(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    budget = content["budget"]["simulations"] = 40
    content["tester"] = {"name": "avfuzzer", "parameters": {"population": budget // 2 + 1}}
    assert read_campaign(content, catalogues).campaign.budget == budget
    one = content.pop("scenario")
    content["scenarios"] = [{"name": name, "scenario": one} for name in ("a", "b")]
    with pytest.raises(InvalidDocument, match="an integer from 2 to 20 "):
        read_campaign(content, catalogues)
