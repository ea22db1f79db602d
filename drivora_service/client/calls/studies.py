"""Studies, their comparison and their export."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from drivora_service.api_paths import PREFIX
from drivora_service.client.call import (
    Call,
    Document,
    Language,
    Listing,
    act,
    document_bytes,
    get,
    make_listing,
    post,
)

if TYPE_CHECKING:
    from drivora_service.api.schemas.studies import Study, StudyInList, StudyValidation
    from drivora_service.studies.comparison.discovery_curves import StudyBands
    from drivora_service.studies.comparison.study_comparison import StudyComparison
    from drivora_service.studies.table_names import TableForm, TableName

_STUDY = f"{PREFIX}/studies/{{study_id}}"


def post_study(document: Document, *, language: Language = "json") -> Call[Study]:
    """Has the service run a study; returns it with notes.

    Raises:
        InvalidDocument: It cannot be run.
    """
    from drivora_service.api.schemas.studies import Study

    return post(f"{PREFIX}/studies", Study, document_bytes(document), language=language)


def validate_study(document: Document, *, language: Language = "json") -> Call[StudyValidation]:
    """Checks a study as posting it would, and counts its campaigns and simulations.

    Raises:
        InvalidDocument: It cannot be run.
    """
    from drivora_service.api.schemas.studies import StudyValidation

    return post(
        f"{PREFIX}/studies:validate",
        StudyValidation,
        document_bytes(document),
        language=language,
        only_checks=True,
    )


def studies(*, limit: int | None = None) -> Listing[StudyInList]:
    """Returns studies, newest first; at most ``limit``."""
    from drivora_service.api.schemas.studies import StudyInList

    return make_listing(f"{PREFIX}/studies", StudyInList, limit)


def study(study_id: str) -> Call[Study]:
    """Returns how far a study is; :meth:`campaigns` lists its campaigns."""
    from drivora_service.api.schemas.studies import Study

    return get(_STUDY, Study, study_id=study_id)


def pause_study(study_id: str) -> Call[Study]:
    """Pauses the campaigns of a study.

    Raises:
        RequestConflict: All are over.
    """
    return _study_act("pause", study_id)


def resume_study(study_id: str) -> Call[Study]:
    """Resumes the campaigns of a study that were paused or have failed.

    Raises:
        RequestConflict: All are over, or a process works on it.
    """
    return _study_act("resume", study_id)


def cancel_study(study_id: str) -> Call[Study]:
    """Cancels the campaigns of a study that are not over permanently; what was found stays.

    Raises:
        RequestConflict: All are finished.
    """
    return _study_act("cancel", study_id)


def compare_study(
    study_id: str,
    *,
    baseline_method: str = "",
    baseline_agent: str = "",
    measures: Sequence[str] = (),
    equal_time: bool = False,
) -> Call[StudyComparison]:
    """Compares the finished campaigns of a study by method and by agent.

    Args:
        study_id: Id of the study.
        baseline_method: Method that the others are compared with; "": random, or the first one.
        baseline_agent: Agent that the others are compared with; "": the first one.
        measures: Names of what they are compared by; empty: the headlines.
        equal_time: Count what each had done after the time that the shortest one took.
    """
    from drivora_service.studies.comparison.study_comparison import StudyComparison

    query = {
        "baseline_method": baseline_method,
        "baseline_agent": baseline_agent,
        "measure": tuple(measures),
        "equal_time": equal_time or None,
    }
    return get(f"{_STUDY}/comparison", StudyComparison, query=query, study_id=study_id)


def study_bands(
    study_id: str,
    *,
    methods: Sequence[str] = (),
    scenarios: Sequence[str] = (),
    agents: Sequence[str] = (),
    points: int | None = None,
) -> Call[StudyBands]:
    """Returns median and quartiles of the repetitions of a study: failures against simulations.

    Args:
        study_id: Id of the study.
        methods: Names of methods; empty: all.
        scenarios: Names of scenarios; empty: all.
        agents: Names of agents; empty: all.
        points: Greatest number of points of a band; ``None``: as the service has it.
    """
    from drivora_service.studies.comparison.discovery_curves import StudyBands

    query = {
        "method": tuple(methods),
        "scenario": tuple(scenarios),
        "agent": tuple(agents),
        "points": points,
    }
    return get(f"{_STUDY}/bands", StudyBands, query=query, study_id=study_id)


def study_table(
    study_id: str,
    table: TableName,
    *,
    columns: Sequence[str] = (),
    form: TableForm | None = None,
) -> Call[bytes]:
    """Returns the campaigns, evaluations or failures of a study as a file.

    Args:
        study_id: Id of the study.
        table: Which table.
        columns: Names of its columns; empty: all.
        form: As which file; ``None``: Parquet.
    """
    from drivora_service.studies.table_names import TableForm

    return get(
        f"{_STUDY}/tables/{{table}}",
        bytes,
        query={"column": tuple(columns)},
        accept=form or TableForm.PARQUET,
        study_id=study_id,
        table=table,
    )


def _study_act(action: str, study_id: str) -> Call[Study]:
    from drivora_service.api.schemas.studies import Study

    return act(f"{_STUDY}:{action}", Study, study_id=study_id)
