"""Candidates in the queue are read back as they were written."""

from __future__ import annotations

import pytest

from drivora_service.runs.candidate import CandidateSource, Reference, SpaceSource
from drivora_service.store.queue.queued_candidates import source_from_json, source_to_json

PATH = ((0.0, 1.5, -2.0, 0.1, 10.0, 0.0), (9.25, 1e-7, 4.0, -3.1, 0.0, 6.5))


@pytest.mark.parametrize(
    "reference", [None, Reference(), Reference(paths=(PATH,)), Reference(paths=(PATH, PATH))]
)
def test_genes_their_space_and_their_reference_come_back(reference: Reference | None) -> None:
    source = CandidateSource(
        space=SpaceSource(seed="{}", options="{}"), values=(0.1, 2.0), reference=reference
    )
    assert source_from_json(source_to_json(source), "{}") == source


def test_without_a_reference_the_text_is_as_before_there_were_any() -> None:
    source = CandidateSource(space=SpaceSource(seed="{}", options="{}"), values=(0.5,))
    assert "reference" not in source_to_json(source)
