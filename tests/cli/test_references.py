"""Every command that takes an id takes names, first digits and `latest`, here and of a service."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any
from unittest import mock

import pytest
import typer.main
from typer.core import TyperGroup

from drivora_service.agents.configuration import AgentConfiguration
from drivora_service.api.documentation.recorded_examples import SCENARIO, STUDY
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.cli.command_aliases import ALIASES
from drivora_service.cli.main import app
from drivora_service.client import Client
from drivora_service.errors import NotFound
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.validation import validate_data
from drivora_service.store.campaigns.campaign_records import CampaignState
from drivora_service.store.database import Database, open_database
from drivora_service.store.failures.group_records import NewDecision, group_id
from drivora_service.store.id_records import IdKind
from drivora_service.store.runs.run_records import Priority
from drivora_service.studies.study_documents import study_text
from drivora_service.studies.study_reading import read_study
from tests.built_commands import COMMANDS
from tests.forked_service import forked_service
from tests.store.samples import claim, finish, finished, new_run, register

NAMED_BY_IDS = {
    *("RUN", "BATCH", "CAMPAIGN", "STUDY", "GROUP", "CONFIGURATION", "MINIMIZATION"),
    *("ID", "IDS", "OTHER"),
}
"""Words of metavars that stand for what has ids."""

NO_IDS = {
    *("AGENT", "DIR", "EXPRESSION", "FILE", "FORM", "FOLDER", "I", "METHOD", "N", "NAME", "NUMBER"),
    *("ORACLE", "RESULTS", "RUNS", "SCENARIO", "STATUS", "SUITE", "TAG", "TEXT", "TIME", "TRACE"),
    *(
        "KIND",
        "SEEDFILE",
        "URL",
        "VALUE",
        "WORD",
        "ADDRESS",
        "METRES",
        "DAYS",
        "agent",
        "all",
        "none",
    ),
}
"""Words of metavars that stand for what has no id: numbers, files, names of catalogues."""

Key = tuple[str, str]
"""A command, and an argument or option of it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """How a command is given an id.

    Attributes:
        kinds: What it is an id of; the first kind is tried.
        line: Arguments; "@" is the id.
        names_may_be_shared: Whether a name of several is no error.
    """

    kinds: tuple[IdKind, ...]
    line: tuple[str, ...]
    names_may_be_shared: bool = False


def case(kind: IdKind, *line: str, **others: Any) -> Case:
    return Case(kinds=(kind,), line=line, **others)


RUN, BATCH, CAMPAIGN = IdKind.RUN, IdKind.BATCH, IdKind.CAMPAIGN
STUDIES, GROUP, CONFIGURATION = IdKind.STUDY, IdKind.FAILURE_GROUP, IdKind.CONFIGURATION

CASES: Mapping[Key, Case] = {
    ("runs show", "run"): case(RUN, "@", "--json"),
    ("runs scenario", "run"): case(RUN, "@"),
    ("runs list", "--batch"): case(BATCH, "--batch", "@", "--json"),
    ("runs list", "--configuration"): case(CONFIGURATION, "--configuration", "@", "--json"),
    ("plot", "run"): case(RUN, "@"),
    ("minimize", "run"): case(RUN, "@", "--oracle", "arrival"),
    ("rejudge", "traces"): case(RUN, "@"),
    ("replay", "runs"): case(RUN, "@"),
    ("replay", "--batch"): case(BATCH, "--batch", "@"),
    ("replay", "--campaign"): case(CAMPAIGN, "--campaign", "@"),
    ("compare", "wanted"): case(BATCH, "@", "@", "--json", names_may_be_shared=True),
    ("export", "--batch"): case(BATCH, "--batch", "@", "--out", "tables"),
    ("export", "--campaign"): case(
        CAMPAIGN, "--campaign", "@", "--out", "tables", names_may_be_shared=True
    ),
    ("export", "--study"): case(STUDIES, "--study", "@", "--out", "tables"),
    ("export", "--configuration"): case(CONFIGURATION, "--configuration", "@", "--out", "tables"),
    ("batches show", "batch"): case(BATCH, "@"),
    ("campaign show", "campaign"): case(CAMPAIGN, "@"),
    ("campaign scenario", "campaign"): case(CAMPAIGN, "@", "0"),
    ("campaign pause", "campaign"): case(CAMPAIGN, "@"),
    ("campaign cancel", "campaign"): case(CAMPAIGN, "@"),
    ("campaign resume", "campaign"): case(CAMPAIGN, "@"),
    ("campaign report", "campaign"): case(CAMPAIGN, "@"),
    ("campaign compare", "wanted"): case(CAMPAIGN, "@", names_may_be_shared=True),
    ("campaign export", "campaigns"): case(CAMPAIGN, "@", "--suite", "found"),
    ("study show", "study"): case(STUDIES, "@"),
    ("study pause", "study"): case(STUDIES, "@"),
    ("study cancel", "study"): case(STUDIES, "@"),
    ("study resume", "study"): case(STUDIES, "@"),
    ("study compare", "study"): case(STUDIES, "@"),
    ("study export", "study"): case(STUDIES, "@", "--out", "tables"),
    ("failures list", "--group"): case(GROUP, "--group", "@", "--json"),
    ("failures list", "--configuration"): case(CONFIGURATION, "--configuration", "@", "--json"),
    ("failures list", "--campaign"): case(CAMPAIGN, "--campaign", "@", "--json"),
    ("failures list", "--study"): case(STUDIES, "--study", "@", "--json"),
    ("failures list", "--batch"): case(BATCH, "--batch", "@", "--json"),
    ("failures groups", "--baseline"): Case(
        kinds=(BATCH, CAMPAIGN, STUDIES), line=("--baseline", "@", "--json")
    ),
    ("failures groups", "--configuration"): case(CONFIGURATION, "--configuration", "@", "--json"),
    ("failures groups", "--campaign"): case(CAMPAIGN, "--campaign", "@", "--json"),
    ("failures groups", "--study"): case(STUDIES, "--study", "@", "--json"),
    ("failures groups", "--batch"): case(BATCH, "--batch", "@", "--json"),
    ("failures show", "group"): case(GROUP, "@"),
    ("failures decide", "group"): case(GROUP, "@", "--note", "Seen."),
    ("failures merge", "into"): case(GROUP, "@", "@"),
    ("failures merge", "others"): case(GROUP, "@", "@"),
    ("failures split", "group"): case(GROUP, "@", "--name", "no such name"),
    ("suite history", "--configuration"): case(CONFIGURATION, "smoke", "--configuration", "@"),
}

TRIED_ELSEWHERE = {("campaign run", "--start-from")}
"""It also needs a campaign on the same scenario: see `campaigns/test_campaign_starts.py`."""

CONFIGURATIONS = ("0123abcd", "0123abce", "c4b436a4")
_VIOLATED = ("collision", "speeding", "red_light")


def commands(group: TyperGroup, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yields the commands of a group with their names."""
    for name, command in group.commands.items():
        if isinstance(command, TyperGroup):
            yield from commands(command, f"{prefix}{name} ")
        else:
            yield f"{prefix}{name}", command


def words_of(parameter: Any) -> set[str]:
    """The words of the metavar of an argument or option."""
    return set(re.findall(r"[A-Za-z]+", parameter.metavar or ""))


def taking_ids() -> Iterator[Key]:
    """Yields the arguments and options that take ids."""
    assert isinstance(COMMANDS, TyperGroup)
    for name, command in commands(COMMANDS):
        for parameter in command.params:
            says_so = re.search(r"\bids?\b", getattr(parameter, "help", None) or "", re.IGNORECASE)
            is_flag = getattr(parameter, "is_flag", False)
            is_form = "FORM" in words_of(parameter)
            if words_of(parameter) & NAMED_BY_IDS or (says_so and not is_flag and not is_form):
                yield name, parameter.opts[-1]


def test_every_argument_that_takes_an_id_is_tried() -> None:
    assert sorted(taking_ids()) == sorted(CASES.keys() | TRIED_ELSEWHERE)


def test_every_other_argument_takes_something_that_has_no_id() -> None:
    """Who adds an argument decides which it is, here."""
    assert isinstance(COMMANDS, TyperGroup)
    words = {
        word
        for _, command in commands(COMMANDS)
        for parameter in command.params
        for word in words_of(parameter)
    }
    assert words - NAMED_BY_IDS == NO_IDS


def store_all(database: Database, catalogues: Catalogues) -> None:
    """Stores things of every kind: two of one name, and then one of another."""
    names = ("same", "same", "acme, first")
    scenario = validate_data(SCENARIO, catalogues.networks, ("idm",)).scenario
    study = read_study(json.dumps(STUDY), catalogues)
    with database.write() as transaction:
        for place, name in enumerate(names):
            configuration = AgentConfiguration(
                words=f"{name} {CONFIGURATION}", id=CONFIGURATIONS[place]
            )
            batch = transaction.batches.create(name=f"{name} {BATCH}", priority=Priority.CI).id
            run = new_run(
                canonical_json(scenario), label=f"{name} {RUN}", configuration=configuration
            )
            transaction.jobs.submit([run], batch_id=batch)
            study_id = transaction.studies.create(
                name=f"{name} {STUDIES}", document=study_text(study.document)
            )
            campaign = replace(
                study.campaigns[place],
                name=f"{name} {CAMPAIGN}",
                configuration=configuration,
                study_id=study_id,
            )
            transaction.campaigns.create(campaign)
    owner = register(database)
    for run_id, oracle in zip(claim(database, owner, 3), _VIOLATED, strict=True):
        finish(database, owner, finished(run_id, oracle))
    with database.write() as transaction:
        for one in transaction.campaigns.page().items:
            transaction.campaigns.end(one.id, CampaignState.CANCELLED)
        for oracle, name in zip(_VIOLATED, names, strict=True):
            transaction.decisions.decide(group_id(oracle), NewDecision(label=f"{name} {GROUP}"))
        transaction.workers.leave(owner)


@pytest.fixture(scope="module")
def stored(
    tmp_path_factory: pytest.TempPathFactory, empty_database: Path, catalogues: Catalogues
) -> Path:
    """A data folder with things of every kind."""
    folder = tmp_path_factory.mktemp("stored") / "data"
    folder.mkdir(mode=0o700)
    shutil.copy(empty_database, folder / "drivora.sqlite3")
    database = open_database(f"sqlite:///{folder / 'drivora.sqlite3'}")
    store_all(database, catalogues)
    database.close()
    return folder


@dataclass(frozen=True, slots=True)
class Ended:
    """A command that has ended, without what differs from one time to the next."""

    code: int
    out: str
    err: str
    asked: tuple[str, ...] = field(compare=False)


Drivora = Callable[..., Ended]


@pytest.fixture(params=["in process", "service"])
def drivora(
    request: pytest.FixtureRequest,
    stored: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> Drivora:
    """Runs commands in this process on a data folder, or as clients of a service."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("DRIVORA_WORKERS", "1")
    if request.param == "service":
        where = ("--server", request.getfixturevalue("serving"))
    else:
        shutil.copytree(stored, tmp_path / "data")
        where = ("--data-dir", str(tmp_path / "data"))
    asked: list[str] = []
    for name in ("ask", "save"):
        _note_calls(monkeypatch, name, asked)

    def run(*arguments: str) -> Ended:
        asked.clear()
        capfd.readouterr()
        with (
            mock.patch.object(typer.main, "get_command", return_value=COMMANDS),
            pytest.raises(SystemExit) as ended,
        ):
            app([*arguments, *where])
        for name in ("tables", "found"):
            shutil.rmtree(tmp_path / name, ignore_errors=True)
        out, err = capfd.readouterr()
        return Ended(int(ended.value.code or 0), _steady(out), _steady(err), tuple(asked))

    return run


def _note_calls(monkeypatch: pytest.MonkeyPatch, name: str, asked: list[str]) -> None:
    """Has a method of clients note the calls that it makes."""
    method = getattr(Client, name)

    def noted(client: Client, call: Any, *others: Any) -> Any:
        asked.append(f"{call.method} {call.path} {call.parameters}")
        return method(client, call, *others)

    monkeypatch.setattr(Client, name, noted)


def _steady(text: str) -> str:
    """Returns a text without times, and without the ids of what the command itself made."""
    return re.sub(r"\d+\.\d+ s|\d\d:\d\d:\d\d", "TIME", text)


@pytest.fixture(scope="module")
def serving(stored: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A service on a copy of the data folder."""
    data = tmp_path_factory.mktemp("served") / "data"
    shutil.copytree(stored, data)
    with forked_service(data, workers=1) as url:
        yield url


def ids_of(drivora: Drivora, kind: IdKind) -> list[str]:
    """The ids of all things of a kind, the newest first."""
    lists = {
        RUN: ("runs", "list"),
        BATCH: ("batches", "list"),
        CAMPAIGN: ("campaign", "list"),
        STUDIES: ("study", "list"),
        GROUP: ("failures", "groups"),
    }
    if kind is CONFIGURATION:
        return [*CONFIGURATIONS[::-1]]
    return drivora(*lists[kind], "--id-only").out.split()


@pytest.mark.parametrize("key", CASES, ids=" ".join)
def test_a_name_first_digits_and_latest_do_what_the_id_does(drivora: Drivora, key: Key) -> None:
    tried, command = CASES[key], key[0].split()

    def run(wanted: str) -> Ended:
        return drivora(*command, *(wanted if one == "@" else one for one in tried.line))

    kind = tried.kinds[0]
    newest, *others = (one for kind in tried.kinds for one in ids_of(drivora, kind))
    digits = next(n for n in range(4, 25) if not any(one.startswith(newest[:n]) for one in others))
    by_id = run(newest)
    assert newest in " ".join((*by_id.asked, by_id.out, by_id.err))
    # Of several kinds, campaigns were stored last.
    last = by_id if len(tried.kinds) == 1 else run(ids_of(drivora, CAMPAIGN)[0])
    names = {f"acme, first {kind}": by_id, newest[:digits]: by_id, "latest": last}
    for wanted, meant in names.items():
        named = run(wanted)
        assert named == meant, wanted
        assert sum(" /api/v1/ids " in one for one in named.asked) <= tried.line.count("@")


@pytest.mark.parametrize("drivora", ["in process"], indirect=True)
@pytest.mark.parametrize("key", CASES, ids=" ".join)
def test_what_means_nothing_or_several_things_is_a_usage_error(drivora: Drivora, key: Key) -> None:
    tried, command = CASES[key], key[0].split()

    def run(wanted: str) -> Ended:
        return drivora(*command, *(wanted if one == "@" else one for one in tried.line))

    kind = tried.kinds[0]
    unknown = run("acme")
    assert unknown.code == 2
    assert "unknown " in unknown.err
    assert f"acme, first {kind}" in unknown.err
    if not tried.names_may_be_shared:
        several = run(f"same {kind}")
        _, *others = ids_of(drivora, kind)
        assert several.code == 2
        lines = [line.split()[0] for line in several.err.splitlines() if "UTC" in line]
        assert lines == others
        assert several.err.count(f"same {kind}") == 3


def test_a_service_says_what_a_name_may_mean(serving: str) -> None:
    with Client(serving) as client:
        for wanted, message in (
            ("same run", "'same run' is the name of 2 runs"),
            ("acme", "Did you mean 'acme, first run'"),
        ):
            with pytest.raises(NotFound, match=f"the service refused: .*{message}"):
                client.find_id([RUN], wanted)


@pytest.mark.parametrize("drivora", ["in process"], indirect=True)
@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        (("run", "show", "latest"), ("runs", "show", "latest")),
        (("run", "list"), ("runs", "list")),
        (("campaigns", "list"), ("campaign", "list")),
        (("batch", "show", "latest"), ("batches", "show", "latest")),
        (("studies", "show", "latest"), ("study", "show", "latest")),
        (("failure", "groups"), ("failures", "groups")),
    ],
)
def test_singular_and_plural_are_one_command(
    drivora: Drivora, typed: tuple[str, ...], meant: tuple[str, ...]
) -> None:
    ended = drivora(*typed)
    assert ended.code == 0
    assert ended == drivora(*meant)


@pytest.mark.parametrize("drivora", ["in process"], indirect=True)
def test_a_folder_with_the_name_of_a_command_is_run(drivora: Drivora, tmp_path: Path) -> None:
    (tmp_path / "show").mkdir()
    ended = drivora("run", "show")
    assert ended.code == 2
    assert "show" in ended.err
    assert "Usage" not in ended.err


def test_other_spellings_are_of_commands_that_there_are() -> None:
    assert isinstance(COMMANDS, TyperGroup)
    assert {*ALIASES.values()} <= {*COMMANDS.commands}
    assert not {*ALIASES} & {*COMMANDS.commands}
