"""Links between the pages, and from the index and the lists of its readers to every page."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

_ROOT = Path(__file__).resolve().parents[2]
READERS = ("engineers", "researchers", "operators", "contributors")
MOST_LINKS = 30
"""Links of the index: a reader looks for a question, not through a list."""
_LINK = re.compile(r"\]\(([^)\s]+)\)")
PAGES = sorted(
    path.relative_to(_ROOT).as_posix()
    for pattern in ("*.md", "docs/**/*.md", "sumo_nets/*.md", "deploy/*.md")
    for path in _ROOT.glob(pattern)
)


def _links(page: Path) -> list[str]:
    text = re.sub(r"^```.*?^```$", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)
    return [link for link in _LINK.findall(text) if "://" not in link]


def _anchors(page: Path) -> set[str]:
    headings = re.findall(r"^#+ (.+)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", text.lower()).strip().replace(" ", "-") for text in headings}


@pytest.mark.parametrize("page", PAGES)
def test_no_link_is_dead(page: str) -> None:
    source = _ROOT / page
    for link in _links(source):
        path, _, anchor = link.partition("#")
        target = (source.parent / path).resolve() if path else source
        assert target.exists(), link
        assert not anchor or anchor in _anchors(target), link


def test_the_index_and_the_lists_of_readers_lead_to_every_page() -> None:
    docs = _ROOT / "docs"
    index = docs / "index.md"
    lists = [docs / f"{reader}.md" for reader in READERS]
    reached = {
        (page.parent / link.partition("#")[0]).resolve()
        for page in (index, *lists, docs / "decisions" / "index.md")
        for link in _links(page)
    }
    pages = {path.resolve() for path in docs.rglob("*.md")} - {index}
    assert sorted(path.name for path in pages - reached) == []


def test_the_index_can_be_read_at_a_glance() -> None:
    assert len(_links(_ROOT / "docs" / "index.md")) <= MOST_LINKS
