"""The failures of all campaigns and batches, page by page.

Lists read the table from its end, whatever the filter: its rows are narrow and in the order of
finding, so that tens of thousands take a few milliseconds.
"""

from __future__ import annotations

from sqlalchemy import select
from sqlalchemy.orm import Session

from drivora_service.errors import UnknownName
from drivora_service.store.engine.paging import make_token, read_token
from drivora_service.store.failures.failure_queries import conditions_of, failures_of
from drivora_service.store.failures.failure_records import FoundFailure, FoundFilter
from drivora_service.store.failures.failure_tables import FoundRow
from drivora_service.store.failures.found_counting import FoundCounts, count_found
from drivora_service.store.runs.run_records import Page


class FoundRepository:
    """Reads the failures of all campaigns and batches."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def page(
        self,
        wanted: FoundFilter = FoundFilter(),  # noqa: B008 # frozen
        *,
        limit: int = 50,
        page_token: str = "",
    ) -> Page[FoundFailure]:
        """Returns the failures that pass a filter, the last found first.

        Raises:
            InvalidDocument: The token is not one of this query.
        """
        scope = f"found failures {wanted}"
        conditions = conditions_of(self._session, wanted)
        if conditions is None:
            return Page(items=())
        query = select(FoundRow.seq).where(*conditions).order_by(FoundRow.seq.desc())
        if page_token:
            query = query.where(FoundRow.seq < read_token(scope, page_token))
        found = self._session.scalars(query.limit(limit + 1)).all()
        shown = found[:limit]
        more = make_token(scope, shown[-1]) if len(found) > limit else ""
        failures = failures_of(self._session, shown)
        return Page(items=tuple(failures[seq] for seq in shown), next_page_token=more)

    def failure(self, failure_id: int) -> FoundFailure:
        """Returns one failure.

        Raises:
            UnknownName: There is none of this id.
        """
        found = failures_of(self._session, [failure_id])
        if failure_id not in found:
            raise UnknownName("failure", str(failure_id), ())
        return found[failure_id]

    def has_oracle(self, oracle: str) -> bool:
        """Returns whether there is a failure of an oracle, which may be removed by now."""
        query = select(FoundRow.seq).where(FoundRow.oracle == oracle).limit(1)
        return self._session.scalar(query) is not None

    def counts(self, wanted: FoundFilter) -> FoundCounts:
        """Returns the numbers of the failures that pass a filter, and what they count."""
        return count_found(self._session, wanted)
