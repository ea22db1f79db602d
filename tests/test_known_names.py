"""The advice about names that were not found."""

from __future__ import annotations

import pickle

import pytest

from drivora_service.errors import UnknownName
from drivora_service.known_names import advise_name, similar_names, unknown_name_message


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("idmm", "unknown agent 'idmm'; did you mean 'idm'? Known: idm, nmpc"),
        ("IDM", "unknown agent 'IDM'; did you mean 'idm'? Known: idm, nmpc"),
        ("tesla", "unknown agent 'tesla'; known: idm, nmpc"),
    ],
)
def test_the_most_similar_name_is_proposed_and_all_are_listed(given: str, message: str) -> None:
    assert unknown_name_message("agent", given, ("idm", "nmpc")) == message


def test_without_names_nothing_is_listed() -> None:
    assert unknown_name_message("run", "12", ()) == "unknown run '12'"
    assert advise_name("12", ()) == ""


def test_a_long_list_is_shortened_and_counted() -> None:
    names = [f"model-{number}" for number in range(500)]
    advice = advise_name("model-4990", names)
    assert advice.startswith("did you mean 'model-499'? Known: model-0, model-1, ")
    assert advice.endswith(", … (500 in all)")
    assert len(advice) < 1000


def test_very_long_names_are_cut_and_not_compared() -> None:
    long = "idm" * 1000
    assert similar_names(long, (long + "x",)) == ()
    assert len(unknown_name_message("agent", long, ("idm",))) < 150


def test_an_error_between_processes_keeps_its_message() -> None:
    error = UnknownName("network", "town4", ("town-4",), "Import it with `drivora networks import`")
    sent = pickle.loads(pickle.dumps(error))
    assert str(sent) == str(error)
    assert str(error).endswith("Known: town-4. Import it with `drivora networks import`")
