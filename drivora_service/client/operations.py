"""The operations of the API as methods of the clients: declared once, for both."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from functools import wraps
from pathlib import Path
from typing import Any, Concatenate, Generic, ParamSpec, Self, TypeVar, overload

from drivora_service.client.call import Call, Listing
from drivora_service.client.calls import campaigns as campaign_calls
from drivora_service.client.calls import catalogues as catalogue_calls
from drivora_service.client.calls import events as event_calls
from drivora_service.client.calls import failures as failure_calls
from drivora_service.client.calls import ids as id_calls
from drivora_service.client.calls import jobs as job_calls
from drivora_service.client.calls import minimizations as minimization_calls
from drivora_service.client.calls import runs as run_calls
from drivora_service.client.calls import sessions as session_calls
from drivora_service.client.calls import studies as study_calls
from drivora_service.client.calls import suites as suite_calls
from drivora_service.client.calls import tables as table_calls
from drivora_service.client.listening import Event

P = ParamSpec("P")
T = TypeVar("T")


class Answered(Generic[P, T]):
    """A method that makes a call and returns its answer."""

    def __init__(self, make: Callable[P, Call[T]]) -> None:
        self.make = make
        self.__doc__ = make.__doc__

    @overload
    def __get__(self, client: None, owner: type) -> Self: ...
    @overload
    def __get__(self, client: BlockingOperations, owner: type) -> Callable[P, T]: ...
    @overload
    def __get__(self, client: AwaitedOperations, owner: type) -> Callable[P, Awaitable[T]]: ...
    def __get__(self, client: BlockingOperations | AwaitedOperations | None, owner: type) -> Any:
        if client is None:
            return self

        @wraps(self.make)
        def method(*args: P.args, **kwargs: P.kwargs) -> T | Awaitable[T]:
            return client.ask(self.make(*args, **kwargs))

        return method


class Listed(Generic[P, T]):
    """A method that returns the items of a list, page by page as they are wanted."""

    def __init__(self, make: Callable[P, Listing[T]]) -> None:
        self.make = make
        self.__doc__ = make.__doc__

    @overload
    def __get__(self, client: None, owner: type) -> Self: ...
    @overload
    def __get__(self, client: BlockingOperations, owner: type) -> Callable[P, Iterator[T]]: ...
    @overload
    def __get__(self, client: AwaitedOperations, owner: type) -> Callable[P, AsyncIterator[T]]: ...
    def __get__(self, client: BlockingOperations | AwaitedOperations | None, owner: type) -> Any:
        if client is None:
            return self

        @wraps(self.make)
        def method(*args: P.args, **kwargs: P.kwargs) -> Iterator[T] | AsyncIterator[T]:
            return client.items(self.make(*args, **kwargs))

        return method


class Told(Generic[P]):
    """A method that returns the events of a call as they come."""

    def __init__(self, make: Callable[P, Call[bytes]]) -> None:
        self.make = make
        self.__doc__ = make.__doc__

    @overload
    def __get__(self, client: None, owner: type) -> Self: ...
    @overload
    def __get__(self, client: BlockingOperations, owner: type) -> Callable[P, Iterator[Event]]: ...
    @overload
    def __get__(
        self, client: AwaitedOperations, owner: type
    ) -> Callable[P, AsyncIterator[Event]]: ...
    def __get__(self, client: BlockingOperations | AwaitedOperations | None, owner: type) -> Any:
        if client is None:
            return self

        @wraps(self.make)
        def method(*args: P.args, **kwargs: P.kwargs) -> Iterator[Event] | AsyncIterator[Event]:
            return client.listen(self.make(*args, **kwargs))

        return method


class Saved(Generic[P]):
    """A method that writes the answer of a call to a file, which is its first argument.

    The file is whole or absent.
    """

    def __init__(self, make: Callable[P, Call[bytes]]) -> None:
        self.make = make
        self.__doc__ = make.__doc__

    @overload
    def __get__(self, client: None, owner: type) -> Self: ...
    @overload
    def __get__(
        self, client: BlockingOperations, owner: type
    ) -> Callable[Concatenate[Path, P], None]: ...
    @overload
    def __get__(
        self, client: AwaitedOperations, owner: type
    ) -> Callable[Concatenate[Path, P], Awaitable[None]]: ...
    def __get__(self, client: BlockingOperations | AwaitedOperations | None, owner: type) -> Any:
        if client is None:
            return self

        @wraps(self.make)
        def method(path: Path, /, *args: P.args, **kwargs: P.kwargs) -> Awaitable[None] | None:
            return client.save(self.make(*args, **kwargs), path)

        return method


class Operations:
    """One method an operation; an asynchronous client's are awaited, or iterated over so.

    They raise ``InvalidDocument`` where the service refuses a document and ``ServiceError`` where
    it refuses for another reason, does not answer, or answers what cannot be read.
    """

    validate_scenario = Answered(job_calls.validate_scenario)
    inspect_scenario = Answered(job_calls.inspect_scenario)
    post_job = Answered(job_calls.post_job)
    jobs = Listed(job_calls.jobs)
    job = Answered(job_calls.job)
    cancel_job = Answered(job_calls.cancel_job)
    post_batch = Answered(job_calls.post_batch)
    batches = Listed(job_calls.batches)
    batch = Answered(job_calls.batch)
    compare_batches = Answered(job_calls.compare_batches)
    cancel_batch = Answered(job_calls.cancel_batch)
    pause_batch = Answered(job_calls.pause_batch)
    resume_batch = Answered(job_calls.resume_batch)

    runs = Listed(run_calls.runs)
    run_counts = Answered(run_calls.run_counts)
    run = Answered(run_calls.run)
    run_scenario = Answered(run_calls.run_scenario)
    run_observations = Answered(run_calls.run_observations)
    run_perception = Answered(run_calls.run_perception)
    run_series = Answered(run_calls.run_series)
    run_timeline = Answered(run_calls.run_timeline)
    run_picture = Answered(run_calls.run_picture)
    save_run_picture = Saved(run_calls.run_picture)
    save_run_observations = Saved(run_calls.run_observations)

    minimize = Answered(minimization_calls.minimize)
    minimizations = Listed(minimization_calls.minimizations)
    minimization = Answered(minimization_calls.minimization)
    cancel_minimization = Answered(minimization_calls.cancel_minimization)

    post_campaign = Answered(campaign_calls.post_campaign)
    validate_campaign = Answered(campaign_calls.validate_campaign)
    space_presets = Answered(campaign_calls.space_presets)
    campaigns = Listed(campaign_calls.campaigns)
    campaign = Answered(campaign_calls.campaign)
    pause_campaign = Answered(campaign_calls.pause_campaign)
    cancel_campaign = Answered(campaign_calls.cancel_campaign)
    resume_campaign = Answered(campaign_calls.resume_campaign)
    evaluations = Listed(campaign_calls.evaluations)
    evaluation = Answered(campaign_calls.evaluation)
    evaluation_scenario = Answered(campaign_calls.evaluation_scenario)
    evaluation_observations = Answered(campaign_calls.evaluation_observations)
    save_evaluation_observations = Saved(campaign_calls.evaluation_observations)
    evaluation_picture = Answered(campaign_calls.evaluation_picture)
    save_evaluation_picture = Saved(campaign_calls.evaluation_picture)
    campaign_table = Answered(campaign_calls.campaign_table)
    save_campaign_table = Saved(campaign_calls.campaign_table)
    failures = Listed(campaign_calls.failures)
    figures = Answered(campaign_calls.figures)
    coverage = Answered(campaign_calls.coverage)
    discoveries = Answered(campaign_calls.discoveries)
    compare_campaigns = Answered(campaign_calls.compare_campaigns)

    found_failures = Listed(failure_calls.found_failures)
    found_counts = Answered(failure_calls.found_counts)
    found_failure = Answered(failure_calls.found_failure)
    failure_groups = Listed(failure_calls.failure_groups)
    failure_group = Answered(failure_calls.failure_group)
    failure_group_changes = Answered(failure_calls.failure_group_changes)
    decide_group = Answered(failure_calls.decide_group)
    merge_groups = Answered(failure_calls.merge_groups)
    split_group = Answered(failure_calls.split_group)

    post_suite_run = Answered(suite_calls.post_suite_run)
    suites = Answered(suite_calls.suites)
    suite_runs = Listed(suite_calls.suite_runs)
    suite_run = Answered(suite_calls.suite_run)
    suite_history = Answered(suite_calls.suite_history)

    post_study = Answered(study_calls.post_study)
    validate_study = Answered(study_calls.validate_study)
    studies = Listed(study_calls.studies)
    study = Answered(study_calls.study)
    pause_study = Answered(study_calls.pause_study)
    resume_study = Answered(study_calls.resume_study)
    cancel_study = Answered(study_calls.cancel_study)
    compare_study = Answered(study_calls.compare_study)
    study_bands = Answered(study_calls.study_bands)
    study_table = Answered(study_calls.study_table)
    save_study_table = Saved(study_calls.study_table)

    result_table = Answered(table_calls.result_table)
    save_result_table = Saved(table_calls.result_table)

    find_id = Answered(id_calls.find_id)

    events = Told(event_calls.events)

    session = Answered(session_calls.session)
    begin_session = Answered(session_calls.begin_session)
    end_session = Answered(session_calls.end_session)

    example_scenarios = Answered(catalogue_calls.example_scenarios)
    networks = Answered(catalogue_calls.networks)
    network = Answered(catalogue_calls.network)
    import_network = Answered(catalogue_calls.import_network)
    network_geometry = Answered(catalogue_calls.network_geometry)
    agents = Answered(catalogue_calls.agents)
    models = Answered(catalogue_calls.models)
    testers = Answered(catalogue_calls.testers)
    oracles = Answered(catalogue_calls.oracles)
    describe_metrics = Answered(catalogue_calls.describe_metrics)
    workers = Answered(catalogue_calls.workers)
    health = Answered(catalogue_calls.health)
    readiness = Answered(catalogue_calls.readiness)
    metrics = Answered(catalogue_calls.metrics)


class BlockingOperations(Operations, ABC):
    """The operations of a client whose methods return when they are answered."""

    @abstractmethod
    def ask(self, call: Call[T]) -> T:
        """Sends the request of a call and returns its answer."""

    @abstractmethod
    def items(self, listing: Listing[T]) -> Iterator[T]:
        """Returns the items of a list; a page is asked for when its first item is wanted."""

    @abstractmethod
    def listen(self, call: Call[bytes]) -> Iterator[Event]:
        """Returns the events of a call as they come; it is made when the first is wanted."""

    @abstractmethod
    def save(self, call: Call[bytes], path: Path) -> None:
        """Writes the answer of a call to a file as it comes; the file is whole or absent.

        Raises:
            StoreError: The file cannot be written.
        """


class AwaitedOperations(Operations, ABC):
    """The operations of a client whose methods are awaited."""

    @abstractmethod
    async def ask(self, call: Call[T]) -> T:
        """Sends the request of a call and returns its answer."""

    @abstractmethod
    def items(self, listing: Listing[T]) -> AsyncIterator[T]:
        """Returns the items of a list; a page is asked for when its first item is wanted."""

    @abstractmethod
    def listen(self, call: Call[bytes]) -> AsyncIterator[Event]:
        """Returns the events of a call as they come; it is made when the first is wanted."""

    @abstractmethod
    async def save(self, call: Call[bytes], path: Path) -> None:
        """Writes the answer of a call to a file as it comes; the file is whole or absent.

        Raises:
            StoreError: The file cannot be written.
        """
