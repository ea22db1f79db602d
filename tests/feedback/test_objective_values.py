from __future__ import annotations

import copy
import json
import pickle

import pytest

from drivora_service.errors import SearchError, UnknownObjective
from drivora_service.feedback.measurement import Measurement
from drivora_service.feedback.objective_values import ObjectiveValues

VALUES = ObjectiveValues({"min_gap": 0.5, "progress": None})


def test_a_name_that_was_not_measured_is_refused() -> None:
    for ask in (VALUES.get, VALUES.__getitem__):
        with pytest.raises(UnknownObjective, match=r"'min_gop' .*did you mean 'min_gap'") as told:
            ask("min_gop")
        assert "Measured: min_gap, progress" in str(told.value)
        assert isinstance(told.value, SearchError)
    with pytest.raises(UnknownObjective, match="Measured: none"):
        ObjectiveValues()["min_gap"]


def test_what_is_not_measurable_is_none() -> None:
    assert VALUES["progress"] is None
    assert VALUES.get("progress") is None
    assert VALUES.get("progress", 1.0) == 1.0
    assert VALUES.get("min_gap", 1.0) == 0.5
    assert "min_gop" not in VALUES


def test_it_is_a_dictionary_for_all_else() -> None:
    assert VALUES == {"min_gap": 0.5, "progress": None}
    assert json.loads(json.dumps(VALUES)) == VALUES
    for other in (pickle.loads(pickle.dumps(VALUES)), copy.deepcopy(VALUES)):
        assert other == VALUES
        with pytest.raises(UnknownObjective):
            other["min_gop"]


def test_the_error_can_be_sent_to_another_process() -> None:
    error = UnknownObjective("a", ("b", "c"))
    other = pickle.loads(pickle.dumps(error))
    assert (str(other), other.name, other.known) == (str(error), "a", ("b", "c"))


def test_measurements_have_such_objectives_whatever_they_were_made_of() -> None:
    made = Measurement(objectives={"min_gap": 0.5})
    for one in (made, pickle.loads(pickle.dumps(made))):
        with pytest.raises(UnknownObjective):
            one.objectives.get("min_ttc")
