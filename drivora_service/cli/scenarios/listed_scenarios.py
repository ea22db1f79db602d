"""Documents that list scenarios: in place, or as files, folders and patterns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

from drivora_service.cli.scenarios.scenario_files import (
    describe_unreadable,
    find_files,
    unique_name,
)
from drivora_service.errors import ConfigurationError, InvalidDocument, Problem
from drivora_service.scenario.document_problems import in_document_order
from drivora_service.scenario.importers.reading import FileFormat, detect_format, read_scenarios
from drivora_service.scenario.plain_data import plain_data

_PLACE = "/scenarios/"


@dataclass(frozen=True, slots=True, kw_only=True)
class _Naming:
    """The key of the name of a scenario in the list, and the greatest length of a name."""

    key: str
    longest: int


@dataclass(frozen=True, slots=True, kw_only=True)
class _Source:
    """Where a scenario comes from: its place in the file, and its own file if it has one.

    Attributes:
        is_missing: Whether it stands for a scenario that could not be read.
    """

    place: int
    path: Path | None = None
    is_missing: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class ListFile:
    """A file that lists scenarios, with the scenarios in place of the files that it names.

    Attributes:
        content: The document without files. In place of a scenario that could not be read it has
            an empty one, so that the rest can be checked.
        problems: What is wrong with the text of the file, and why scenarios could not be read.
    """

    content: Mapping[str, Any]
    sources: Sequence[_Source]
    problems: tuple[Problem, ...] = ()

    def in_file(self, error: InvalidDocument) -> InvalidDocument:
        """Returns the problems of the file, and those of the content at their places in the file.

        Args:
            error: The problems of the content.
        """
        found = (self._in_file(problem) for problem in error.problems)
        every = dict.fromkeys((*self.problems, *(one for one in found if one is not None)))
        return InvalidDocument(in_document_order(tuple(every), self._written))

    @property
    def _written(self) -> Mapping[str, Any]:
        """The content with one scenario for each item of the file's list, for the order."""
        items = 1 + max((source.place for source in self.sources), default=-1)
        return {**self.content, "scenarios": [{}] * items} if items else self.content

    def _in_file(self, problem: Problem) -> Problem | None:
        """Returns a problem of the content at its place in the file; ``None``: it says nothing."""
        place, _, inside = problem.pointer.removeprefix(_PLACE).partition("/")
        if not problem.pointer.startswith(_PLACE) or not place.isdigit():
            return problem
        source = self.sources[int(place)]
        pointer = f"{_PLACE}{source.place}"
        if source.is_missing and inside.startswith("document"):
            return None
        rest = inside.removeprefix("document").removeprefix("/")
        if source.path is None or not inside.startswith("document"):
            return replace(problem, pointer=f"{pointer}/{inside}".rstrip("/"))
        where = f"{source.path}: /{rest}" if rest else str(source.path)
        return replace(problem, pointer=pointer, message=f"{where}: {problem.message}")


def read_list_draft(path: Path, *, what: str, name_key: str, longest_name: int) -> ListFile:
    """Reads a file that lists scenarios, and the scenario files that it names, as far as it can.

    Args:
        path: The file, YAML or JSON.
        what: What it holds, for messages.
        name_key: Key of the name of a scenario in the list; one without a name gets that of its
            file.
        longest_name: Greatest number of characters of such a name.

    Raises:
        ConfigurationError: The file cannot be read.
        InvalidDocument: It is no YAML or JSON at all.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ConfigurationError(describe_unreadable(path, error)) from error
    language: Literal["json", "yaml"] = "json" if path.suffix.lower() == ".json" else "yaml"
    content, problems = plain_data(data, language, what=what)
    return _with_scenarios(
        content, problems, folder=path.parent, naming=_Naming(key=name_key, longest=longest_name)
    )


def read_list_file(path: Path, *, what: str, name_key: str, longest_name: int) -> ListFile:
    """Reads a file that lists scenarios, and the scenario files that it names.

    Args:
        path: See :func:`read_list_draft`.
        what: See there.
        name_key: See there.
        longest_name: See there.

    Raises:
        ConfigurationError: The file cannot be read.
        InvalidDocument: It is no YAML or JSON, or a scenario file cannot be read.
    """
    file = read_list_draft(path, what=what, name_key=name_key, longest_name=longest_name)
    if file.problems:
        raise InvalidDocument(file.problems)
    return file


def expand_list(
    content: Mapping[str, Any], *, folder: Path, name_key: str, longest_name: int
) -> ListFile:
    """Puts scenarios in place of the files that a document without a file of its own names.

    Args:
        content: The document.
        folder: Folder to which the names of files are relative.
        name_key: See :func:`read_list_draft`.
        longest_name: See there.
    """
    naming = _Naming(key=name_key, longest=longest_name)
    return _with_scenarios(content, (), folder=folder, naming=naming)


def _with_scenarios(
    content: Mapping[str, Any], problems: Sequence[Problem], *, folder: Path, naming: _Naming
) -> ListFile:
    listed = content.get("scenarios")
    if not isinstance(listed, list):
        if problems and not content:
            raise InvalidDocument(tuple(problems))
        return ListFile(content=content, sources=(), problems=tuple(problems))
    found_problems = list(problems)
    scenarios: list[Any] = []
    sources: list[_Source] = []
    taken = {
        one[naming.key]
        for one in listed
        if isinstance(one, dict) and isinstance(one.get(naming.key), str)
    }
    for place, item in enumerate(listed):
        try:
            for scenario, file in _scenarios(item, folder, taken, naming):
                scenarios.append(scenario)
                sources.append(_Source(place=place, path=file))
        except InvalidDocument as error:
            found_problems += [
                replace(p, pointer=f"{_PLACE}{place}{p.pointer}") for p in error.problems
            ]
            rest = {k: v for k, v in item.items() if k != "file"} if isinstance(item, dict) else {}
            name = {} if naming.key in rest else {naming.key: unique_name("missing", taken)}
            scenarios.append({**rest, **name, "document": {}})
            sources.append(_Source(place=place, is_missing=True))
    return ListFile(
        content={**content, "scenarios": scenarios},
        sources=sources,
        problems=tuple(found_problems),
    )


def _scenarios(
    item: Any, folder: Path, taken: set[str], naming: _Naming
) -> Iterator[tuple[Any, Path | None]]:
    """Yields the scenarios of an item of the list, each with its file; ``None``: it has none."""
    if isinstance(item, Mapping) and "file" not in item:
        yield item, None
        return
    given: Mapping[str, Any] = item if isinstance(item, Mapping) else {"file": item}
    if "document" in given:
        raise _refusal("/document", "found both `file` and `document`; give one of them")
    name = given["file"]
    if not isinstance(name, str) or not name:
        where = "/file" if isinstance(item, Mapping) else ""
        raise _refusal(where, "found no path; a file, a folder or a pattern is needed")
    rest = {key: value for key, value in given.items() if key != "file"}
    found = [
        (stem, content, file) for file in _files(folder, name) for stem, content in _content(file)
    ]
    if naming.key in rest and len(found) > 1:
        raise _refusal(
            f"/{naming.key}",
            f"{name!r} stands for {len(found)} scenarios; a {naming.key} is for one of them",
        )
    for stem, content, file in found:
        if naming.key not in rest:
            unique = unique_name(stem[: naming.longest - 4], taken)
            yield {**rest, naming.key: unique, "document": content}, file
        else:
            yield {**rest, "document": content}, file


def _files(folder: Path, name: str) -> tuple[Path, ...]:
    try:
        if any(character in name for character in "*?["):
            root, pattern = (Path("/"), name[1:]) if name.startswith("/") else (folder, name)
            matching = sorted(root.glob(pattern))
            if not matching:
                raise _refusal("", f"no file matches {name!r} in {folder}")
            return find_files(matching)
        return find_files([folder / name])
    except (ConfigurationError, ValueError, NotImplementedError) as error:
        raise _refusal("", str(error)) from error


def _content(path: Path) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yields the scenarios of a file with their names."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise _refusal("", describe_unreadable(path, error)) from error
    try:
        language = detect_format(data)
        if language in (FileFormat.JSON, FileFormat.YAML):
            # Unchecked: reading the document names the problems of all of it together.
            yield path.stem, _plain(data, "json" if language is FileFormat.JSON else "yaml")
            return
        for one in read_scenarios(data, name=path.stem):
            document = one.document.model_dump(
                mode="json", exclude_defaults=True, exclude_none=True
            )
            yield one.name, document
    except InvalidDocument as error:
        raise InvalidDocument(
            tuple(
                replace(p, pointer="", message=f"{path}: {p.pointer or '/'}: {p.message}")
                for p in error.problems
            )
        ) from error


def _plain(data: bytes, language: Literal["json", "yaml"]) -> Mapping[str, Any]:
    content, problems = plain_data(data, language)
    if problems:
        raise InvalidDocument(tuple(problems))
    return content


def _refusal(pointer: str, message: str) -> InvalidDocument:
    return InvalidDocument((Problem(pointer=pointer, code="scenario_file", message=message),))
