"""The search for a smaller document: passes over its parts, again and again until none finds more.

The search is a generator. It yields questions, ordered lists of proposals, and is sent the first
proposal of each that fails in the same way, or ``None``. It reads nothing else, so that equal
answers lead to an equal result, in whatever order and on however many workers they were found.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass, replace

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.suites.minimization import removals, shortening
from drivora_service.suites.minimization.delta_debugging import minimal_subset
from drivora_service.suites.minimization.edits import Edit, apply_edits
from drivora_service.suites.minimization.later_starts import Recording, later_starts
from drivora_service.suites.minimization.rounding import DECIMALS, make_roundings
from drivora_service.suites.minimization.shortening import Failure

PROOF = "proof"
"""Stage in which every single reduction of the result is tried."""

_MOST_NAMED = 3
"""Number of edits that the label of a proposal names."""


@dataclass(frozen=True, slots=True, kw_only=True)
class State:
    """A document that fails in the same way.

    Attributes:
        failure: Its failure.
        recording: Its run, if it was recorded.
    """

    document: ScenarioDocument
    failure: Failure
    recording: Recording | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Proposal:
    """A proposal: edits of the present document."""

    base: ScenarioDocument
    edits: tuple[Edit, ...]

    def document(self) -> ScenarioDocument | None:
        """Returns the document to try; ``None`` if the edits lead to none."""
        return apply_edits(self.base, self.edits)

    @property
    def label(self) -> str:
        """What the edits do, in a few words."""
        named = "; ".join(edit.label for edit in self.edits[:_MOST_NAMED])
        more = len(self.edits) - _MOST_NAMED
        return f"{named}; and {more} more" if more > 0 else named


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """Proposals in an order, of which the first that fails in the same way is taken.

    Attributes:
        stage: What is being reduced, in one or two words.
        proposals: The proposals.
        is_for_recording: Whether the present document is to be recorded: it is the only proposal.
    """

    stage: str
    proposals: tuple[Proposal, ...]
    is_for_recording: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Taken:
    """The answer to a question: its first proposal that fails in the same way.

    Attributes:
        number: Place of the proposal in the question.
        state: Its document and failure.
    """

    number: int
    state: State


Search = Generator[Question, Taken | None, State]
Parts = Callable[[State], list[Edit]]
Alternatives = Callable[[State], list[list[Edit]]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Reductions:
    """All single reductions of a document, by stage.

    Attributes:
        ego: Ego that fails.
        network: Road network of the document.
    """

    ego: str
    network: RoadNetwork

    def parts(self) -> Iterator[tuple[str, Parts]]:
        """Yields the stages whose edits can be applied together."""
        yield "actors", lambda state: removals.actors(state.document, self.ego)
        yield "settings", lambda state: removals.settings(state.document)
        yield "waypoints", lambda state: removals.waypoints(state.document)
        yield "details", lambda state: removals.details(state.document)

    def alternatives(self) -> Iterator[tuple[str, Alternatives]]:
        """Yields the stages of whose edits at most one of a list is taken."""
        yield "background", lambda state: shortening.fewer_vehicles(state.document)
        yield "time", lambda state: shortening.less_time(state.document, state.failure)
        yield (
            "routes",
            lambda state: shortening.sooner_ends(state.document, state.failure, self.network),
        )
        yield "begin", _later_starts

    def single(self, state: State) -> tuple[Proposal, ...]:
        """Returns every single reduction of a document."""
        edits = [edit for _, parts in self.parts() for edit in parts(state)]
        edits += [
            edit
            for _, alternatives in self.alternatives()
            for choices in alternatives(state)
            for edit in choices
        ]
        for decimals in DECIMALS:
            edits += make_roundings(state.document, decimals)
        return tuple(Proposal(base=state.document, edits=(edit,)) for edit in edits)


def smallest(state: State, reductions: Reductions) -> Search:
    """Searches a document that fails in the same way and has no single reduction that does.

    Args:
        state: The document to begin with.
        reductions: All reductions that there are.
    """
    # Coarse before fine: an actor takes its waypoints and numbers along, which save their trials.
    # After any success all passes are made again: what was needed with a part may not be without.
    while True:
        before = state.document
        for stage, parts in reductions.parts():
            state = yield from _subset(stage, state, parts(state))
            if stage == "actors":
                # With fewer actors each run is cheaper; with less time, too. Hence these stages
                # come before the other parts.
                for name, alternatives in reductions.alternatives():
                    # A later start needs the motions of the present document, in a trial of its
                    # own: other trials record nothing.
                    if name == "begin":
                        state = yield from _record_run(state)
                    state = yield from _shorter(name, state, alternatives)
        # Last, as rounding makes no run shorter, and with the fewest decimals first: a number that
        # can do without any needs no trial with one.
        for decimals in DECIMALS:
            state = yield from _subset("numbers", state, make_roundings(state.document, decimals))
        if state.document != before:
            continue
        state = yield from _record_run(state)
        # Usually all of these have been answered, and cost no simulation. They are asked once more,
        # so that 1-minimality does not rest on the order of the passes.
        taken = yield Question(stage=PROOF, proposals=reductions.single(state))
        # An answer None is the only way out: no single reduction fails in the same way.
        if taken is None:
            return state
        state = taken.state


def _later_starts(state: State) -> list[list[Edit]]:
    if state.recording is None or state.failure.time is None:
        return []
    return later_starts(state.document, state.recording, state.failure.time)


def _record_run(state: State) -> Search:
    """Returns a state with the recording of its run."""
    if state.recording is not None or state.failure.time is None:
        return state
    # The same document as the only proposal. If it does not fail this time, the search goes on
    # without a recording, and without later starts.
    same = Proposal(base=state.document, edits=())
    taken = yield Question(stage="begin", proposals=(same,), is_for_recording=True)
    return state if taken is None else replace(state, recording=taken.state.recording)


def _subset(stage: str, state: State, edits: Sequence[Edit]) -> Search:
    """Applies as many edits together as there can be, up to 1-minimality."""
    # minimal_subset() keeps parts, and an edit removes one: edits that are kept are not made, all
    # others are made to the document of the beginning, in which their places are valid.
    base, search = state.document, minimal_subset(len(edits))
    try:
        candidates = next(search)
        while True:
            proposals = tuple(
                Proposal(
                    base=base,
                    edits=tuple(edit for n, edit in enumerate(edits) if n not in kept),
                )
                for kept in candidates
            )
            taken = yield Question(stage=stage, proposals=proposals)
            if taken is not None:
                state = taken.state
            candidates = search.send(None if taken is None else taken.number)
    except StopIteration:
        return state


def _shorter(stage: str, state: State, alternatives: Alternatives) -> Search:
    """Takes the first alternative of each list that can be taken."""
    # The lists are made anew after each success, as they depend on the document and its failure.
    # The same one is tried again then, as it may allow more.
    number = 0
    while number < len(lists := alternatives(state)):
        proposals = tuple(Proposal(base=state.document, edits=(edit,)) for edit in lists[number])
        taken = (yield Question(stage=stage, proposals=proposals)) if proposals else None
        if taken is None:
            number += 1
        else:
            state = taken.state
    return state
