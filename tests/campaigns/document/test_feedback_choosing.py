from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_documents import CampaignDocument, campaign_text
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.search.search_preparation import prepare_search
from drivora_service.errors import InvalidDocument, Problem
from drivora_service.feedback.objective_choice import ObjectiveChoice, ObjectiveKind
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from tests.installed_parts import install_parts

LAW = "law_45_speed_limit"
Read = Callable[..., tuple[ObjectiveChoice, ...]]


@pytest.fixture
def problem(content: dict[str, Any], catalogues: Catalogues) -> Callable[..., Problem]:
    """The one problem of a campaign with a choice of objectives."""

    def read(feedback: Any, tester: str = "avfuzzer") -> Problem:
        content.update(feedback=feedback, tester={"name": tester})
        with pytest.raises(InvalidDocument) as refused:
            read_campaign(content, catalogues)
        (only,) = refused.value.problems
        return only

    return read


@pytest.fixture
def chosen(content: dict[str, Any], catalogues: Catalogues) -> Read:
    """The objectives of a campaign with a choice of objectives."""

    def read(feedback: Any, tester: str = "avfuzzer") -> tuple[ObjectiveChoice, ...]:
        content.update(feedback=feedback, tester={"name": tester})
        valid = read_campaign(content, catalogues)
        search = prepare_search(valid, catalogues, run_prefix="r")
        assert search.feedback.objectives == valid.campaign.objectives
        assert search.feedback.name == catalogues.testers.plugin(tester).feedback.name
        # It is read back from the database as it was posted.
        stored = CampaignDocument.model_validate_json(campaign_text(valid.document))
        assert stored.feedback == valid.document.feedback
        return valid.campaign.objectives

    return read


def test_without_a_choice_a_tester_has_its_own(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    assert read_campaign(content, catalogues).campaign.objectives == ()


def test_an_objective_of_another_feedback(chosen: Read) -> None:
    (one,) = chosen({"name": "time_to_collision", "scale": 0.5})
    assert (one.name, one.kind, one.owner) == (
        "time_to_collision",
        ObjectiveKind.FEEDBACK,
        "general",
    )
    assert (one.target, one.scale, one.negated) == (0.0, 0.5, False)


def test_a_name_that_several_have_is_given_with_its_feedback(
    chosen: Read, problem: Callable[..., Problem]
) -> None:
    told = problem({"name": "progress"})
    assert told.pointer == "/feedback/name"
    assert "'general/progress' or 'samota/progress'" in told.message
    (one,) = chosen({"name": "samota/progress"})
    assert (one.name, one.owner, one.member) == ("samota/progress", "samota", "progress")


def test_every_law_is_an_objective(chosen: Read, catalogues: Catalogues) -> None:
    for law in catalogues.oracles.library.names():
        (one,) = chosen({"name": law})
        assert (one.kind, one.owner) == (ObjectiveKind.LAW, law)
        # Robustness of 0 is no violation.
        assert one.target is not None
        assert one.target < 0.0
    (way,) = chosen({"name": f"{LAW}/1"})
    assert (way.kind, way.owner) == (ObjectiveKind.FEEDBACK, "lawbreaker")


@pytest.mark.parametrize(
    ("name", "negated"), [("min_time_to_collision_s", False), ("max_drac_mps2", True)]
)
def test_a_metric_goes_where_it_is_worse_for_the_ads(
    name: str, negated: bool, chosen: Read
) -> None:
    (one,) = chosen({"name": name})
    assert one.negated is negated
    assert one.name == (f"negated_{name}" if negated else name)
    assert one.target is None
    (other,) = chosen({"name": name, "direction": "maximise", "target": 3.0})
    assert (other.negated, other.target) == (True, -3.0)


def test_a_metric_that_is_neither_needs_a_direction(problem: Callable[..., Problem]) -> None:
    told = problem({"name": "mean_speed_mps"})
    assert told.pointer == "/feedback/direction"
    assert "minimise or maximise" in told.message


def test_a_feedback_stands_for_all_of_its_objectives(
    chosen: Read, problem: Callable[..., Problem]
) -> None:
    several = chosen({"name": "samota", "parameters": {"gap": 5.0}}, "lawbreaker")
    assert len(several) == 6
    assert {one.parameters["gap"] for one in several} == {5.0}
    told = problem({"name": "samota"})
    assert told.pointer == "/feedback/name"
    assert "minimises one objective; found lane_centre, vehicle_distance" in told.message
    told = problem({"name": "samota", "parameters": {"gab": 5.0}}, "lawbreaker")
    assert told.pointer == "/feedback/parameters"
    assert "did you mean 'gap'" in told.message


def test_weights_make_one_objective_of_several(
    chosen: Read, problem: Callable[..., Problem]
) -> None:
    objectives = [{"name": "min_gap", "weight": 2.0}, {"name": LAW}]
    assert [one.weight for one in chosen({"objectives": objectives})] == [2.0, 1.0]
    told = problem({"objectives": [{"name": "min_gap"}, {"name": LAW}]})
    assert told.pointer == "/feedback/objectives"
    assert "give each a `weight`" in told.message
    assert len(chosen({"objectives": [{"name": "min_gap"}, {"name": LAW}]}, "samota")) == 2


@pytest.mark.parametrize(
    ("feedback", "pointer", "said"),
    [
        ({"name": "min_ttc"}, "/feedback/name", "did you mean 'min_time_to_collision_s'"),
        ({"name": "min_gop"}, "/feedback/name", "did you mean 'min_gap'"),
        ({"name": "zzz"}, "/feedback/name", "; known: objectives safety_margin"),
        (
            {"objectives": [{"name": "min_gap"}, {"name": "min_gop"}]},
            "/feedback/objectives/1/name",
            "did you mean 'min_gap'",
        ),
        ({"name": "min_gap", "parameters": {"scale": 1}}, "/feedback/parameters", "no parameters"),
        ({"name": "avfuzzer", "direction": "maximise"}, "/feedback/direction", "as they are"),
        ({"name": "min_gap", "direction": "up"}, "/feedback/direction", "'minimise'"),
        ({"name": "min_gap", "scale": 0.0}, "/feedback/scale", "greater than 0"),
        ({"name": "min_gap", "weight": 1.0}, "/feedback/weight", "weight"),
        ({}, "/feedback", "neither of `name` and `objectives`"),
        ({"name": "min_gap", "objectives": [{"name": LAW}]}, "/feedback", "both of `name`"),
        ({"objectives": [{"name": LAW}] * 2}, "/feedback/objectives", "more than once"),
        ({"objectives": [{"name": LAW}], "scale": 2.0}, "/feedback", "scale beside `objectives`"),
    ],
)
def test_a_mistake_is_named_with_its_place(
    feedback: dict[str, Any], pointer: str, said: str, problem: Callable[..., Problem]
) -> None:
    told = problem(feedback)
    assert told.pointer == pointer
    assert said in told.message


def test_all_known_names_are_said(problem: Callable[..., Problem], catalogues: Catalogues) -> None:
    message = problem({"name": "nothing_like_it"}).message
    names = (
        *(metric.name for metric in catalogues.metrics.descriptions()),
        *catalogues.oracles.library.names(),
        *catalogues.feedbacks.names(),
        "violation_degree",
        "law_51_turn_yields/1 to /3",
    )
    assert [name for name in names if name not in message] == []


def test_a_tester_that_cannot_be_directed_refuses(problem: Callable[..., Problem]) -> None:
    pytest.importorskip("stable_baselines3", reason="an extra: `adversary`")
    told = problem({"name": "min_gap"}, "deepcollision")
    assert told.pointer == "/feedback"
    assert "'deepcollision' goes by what its own feedback measures" in told.message


def test_laws_of_lawbreaker_are_chosen_in_one_way(
    content: dict[str, Any], catalogues: Catalogues
) -> None:
    content["tester"] = {"name": "lawbreaker", "parameters": {"laws": [LAW]}}
    content["feedback"] = {"name": "min_gap"}
    with pytest.raises(InvalidDocument, match="leave one of them out"):
        prepare_search(read_campaign(content, catalogues), catalogues, run_prefix="r")


def test_a_note_says_what_is_minimised(content: dict[str, Any], catalogues: Catalogues) -> None:
    content["feedback"] = {"name": "min_gap"}
    notes = read_campaign(content, catalogues).notes
    assert "tester 'random' goes by no objectives: min_gap is measured only" in notes
    content["tester"] = {"name": "avfuzzer"}
    notes = read_campaign(content, catalogues).notes
    assert "tester 'avfuzzer' minimises min_gap in place of its own objectives" in notes


def test_parts_of_a_package_are_named_with_their_version(
    content: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_parts(tmp_path / "site", monkeypatch)
    catalogues = Catalogues(NetworkCatalogue(shipped_networks()))
    content["oracles"] = ["collision"]
    for name, kind in (
        ("walker_spare", ObjectiveKind.ORACLE),
        ("walker_runs/walker_spare", ObjectiveKind.ORACLE),
        ("metric/walker_speed_mps", ObjectiveKind.METRIC),
    ):
        content["feedback"] = {"name": name, "direction": "minimise"}
        valid = read_campaign(content, catalogues)
        (one,) = valid.campaign.objectives
        assert (one.name, one.kind) == (name, kind)
        assert valid.versions["own-parts"] == "0.1"


FEEDBACK = """\
from drivora_service.feedback.measurement import Measurement
from drivora_service.feedback.plugin import FeedbackPlugin

class Length:
    objectives = ("length",)

    def measure(self, run):
        return Measurement(objectives={"length": float(run.trace.step_count)})

def make(parameters):
    return Length()

LENGTH = FeedbackPlugin(name="own-length", description="how long it lasts", create=make)
"""


def test_a_feedback_of_a_package_directs_every_method_that_can_be(
    content: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parts = "[drivora_service.feedback]\nown-length = more_parts:LENGTH\n"
    install_parts(tmp_path / "site", monkeypatch, parts=parts, code=FEEDBACK)
    catalogues = Catalogues(NetworkCatalogue(shipped_networks()))
    content["tester"] = {"name": "avfuzzer"}
    for name in ("own-length", "length"):
        content["feedback"] = {"name": name}
        valid = read_campaign(content, catalogues)
        (one,) = valid.campaign.objectives
        assert (one.name, one.owner, one.kind) == ("length", "own-length", ObjectiveKind.FEEDBACK)
        assert valid.versions["own-parts"] == "0.1"


def test_a_metric_that_cannot_be_loaded_says_why(
    content: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parts = "[drivora_service.metrics]\ngone_s = parts_that_are_gone:METRIC\n"
    install_parts(tmp_path / "site", monkeypatch, parts=parts)
    content["feedback"] = {"name": "gone_s"}
    with pytest.raises(InvalidDocument, match=r"/feedback/name: metric 'gone_s' .*cannot be load"):
        read_campaign(content, Catalogues(NetworkCatalogue(shipped_networks())))
