"""Lists of batches."""

from __future__ import annotations

from collections.abc import Collection
from itertools import chain, combinations

import pytest

from drivora_service.errors import InvalidDocument
from drivora_service.store.database import Database
from drivora_service.store.runs.run_records import Batch, Priority
from tests.store.samples import only_sqlite, submit
from tests.store.test_query_plans import plan, queries

CHOICES = tuple(chain.from_iterable(combinations(Priority, size) for size in range(4)))
"""Each choice of priorities; the first one is none."""


@pytest.fixture
def batches(database: Database) -> list[Batch]:
    """Batches of all priorities, newest first; some runs were submitted singly in between."""
    made = []
    for priority in (*Priority, *[Priority.CAMPAIGN] * 4, *Priority, Priority.CI):
        submit(database, 1)
        with database.write() as transaction:
            made.append(transaction.batches.create(name=priority, priority=priority))
    return made[::-1]


def pages(
    database: Database, priorities: Collection[Priority], *, limit: int
) -> list[tuple[str, ...]]:
    """The ids on the pages of a list."""
    found: list[tuple[str, ...]] = []
    token = ""
    while not found or token:
        with database.read() as transaction:
            page = transaction.batches.page(priorities=priorities, limit=limit, page_token=token)
        found.append(tuple(batch.id for batch in page.items))
        token = page.next_page_token
    return found


@pytest.mark.parametrize("priorities", CHOICES)
@pytest.mark.parametrize("limit", [1, 2, 50])
def test_pages_have_every_batch_of_the_priorities_once(
    database: Database, batches: list[Batch], priorities: tuple[Priority, ...], limit: int
) -> None:
    wanted = [batch.id for batch in batches if batch.priority in (priorities or Priority)]
    found = pages(database, priorities, limit=limit)
    assert list(chain.from_iterable(found)) == wanted
    assert all(len(page) == limit for page in found[:-1])


def test_a_page_token_is_of_its_priorities(database: Database, batches: list[Batch]) -> None:
    ci = (Priority.CI,)
    with database.read() as transaction:
        token = transaction.batches.page(priorities=ci, limit=1).next_page_token
        again = transaction.batches.page(priorities=[*ci, *ci], limit=1, page_token=token)
        assert [batch.priority for batch in again.items] == [Priority.CI]
        for others in ((), (Priority.CAMPAIGN,), (Priority.CI, Priority.CAMPAIGN)):
            with pytest.raises(InvalidDocument, match="page token"):
                transaction.batches.page(priorities=others, limit=1, page_token=token)


@only_sqlite
@pytest.mark.parametrize("priorities", CHOICES)
def test_batches_of_other_priorities_are_not_read(
    database: Database, batches: list[Batch], priorities: tuple[Priority, ...]
) -> None:
    with queries(database) as asked, database.read() as transaction:
        page = transaction.batches.page(priorities=priorities, limit=1)
        transaction.batches.page(priorities=priorities, limit=1, page_token=page.next_page_token)
    steps = [step for query in asked for step in plan(database, *query)]
    assert not any("TEMP B-TREE FOR ORDER BY" in step for step in steps)
    touched = [step for step in steps if "batches" in step]
    if priorities:
        found = [step for step in touched if "USING INDEX ix_batches_priority (priority=?" in step]
        assert len(found) == 2 * len(priorities)
        assert not any(step.startswith("SCAN") for step in touched)
    else:
        # Walked from the end until the page is full.
        assert [step for step in touched if step.startswith("SCAN")] == ["SCAN batches"]
