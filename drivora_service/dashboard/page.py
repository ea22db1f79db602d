"""The built page as routes: one document for every screen, and its files."""

from __future__ import annotations

import gzip
import hashlib
import mimetypes
import re
from collections.abc import Callable, Sequence
from http import HTTPStatus
from pathlib import Path

from starlette.requests import Request
from starlette.responses import FileResponse, Response
from starlette.routing import BaseRoute, Match, Route
from starlette.types import Scope

BUILT = Path(__file__).with_name("built")
"""Where the package's build puts the page."""

SECTIONS = (
    "campaigns",
    "compare",
    "studies",
    "runs",
    "batches",
    "failures",
    "minimizations",
    "suites",
    "author",
    "networks",
    "agents",
    "workers",
    "session",
)
"""First parts of the screens' addresses; the page itself finds the screen."""

_POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self' blob: data:",
        "connect-src 'self'",
        "worker-src 'self'",
        "manifest-src 'self'",
        "base-uri 'none'",
        "form-action 'self'",
        "frame-ancestors 'none'",
    )
)
_HEADERS = {
    "Content-Security-Policy": _POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
}
_NO_SCREENS = frozenset({"api", "docs", "assets", "healthz", "readyz", "metrics", "help"})
"""First parts of addresses that programs ask for: what is not there has no page."""
_ENCODINGS = (("br", ".br"), ("gzip", ".gz"))
"""Forms that the build stores beside each file, the best first."""
HELP = ("when-everything-or-nothing-fails",)
"""Pages of the documentation that the page links to, by their names among the how-to pages."""
_NOT_BUILT = (
    "The page is not in this installation. Install the package again "
    "(`make install`, or `pip install`), or use the API: {root_path}/docs.\n"
)
_ADDRESS = re.compile(r'\b((?:href|src)=")/')
"""Of a file, in the document; scripts and styles name files relative to themselves."""


def page_routes(built: Path = BUILT, *, root_path: str = "") -> Sequence[BaseRoute]:
    """Returns the routes of the page: its document for every screen, and its files.

    Args:
        built: Folder of the built page.
        root_path: Path that the service is under; "": the root of its host.
    """

    def document(request: Request) -> Response:
        if not (built / "index.html").is_file():
            text = _NOT_BUILT.format(root_path=root_path)
            return Response(text, 503, media_type="text/plain")
        # Small, and names the files of one build: always asked for again.
        if root_path:
            return _document_under(root_path, request, built / "index.html")
        return _file(request, built / "index.html", "no-cache")

    def no_screen(request: Request) -> Response:
        # The page itself says that there is no such screen.
        answer = document(request)
        if answer.status_code == HTTPStatus.OK:
            answer.status_code = HTTPStatus.NOT_FOUND
        answer.headers.append("Vary", "Accept, Sec-Fetch-Mode")
        return answer

    def asset(request: Request) -> Response:
        path = built / "assets" / request.path_params["name"]
        # Their names have a hash of their content.
        return _file(request, path, "public, max-age=31536000, immutable")

    def icon(request: Request) -> Response:
        return _file(request, built / "icon.svg", "public, max-age=86400")

    def help_page(request: Request) -> Response:
        name = request.path_params["name"]
        path = help_folder() / f"{name}.md"
        if name not in HELP or not path.is_file():
            return Response("There is no such page.\n", 404, media_type="text/plain")
        headers = {**_HEADERS, "Cache-Control": "no-cache"}
        return FileResponse(path, headers=headers, media_type="text/plain; charset=utf-8")

    screens = ["/", *(f"/{section}" for section in SECTIONS)]
    return [
        *(Route(path, document, include_in_schema=False) for path in screens),
        *(
            Route(f"/{section}/{{rest:path}}", document, include_in_schema=False)
            for section in SECTIONS
        ),
        Route("/assets/{name}", asset, include_in_schema=False),
        Route("/icon.svg", icon, include_in_schema=False),
        Route("/help/{name}", help_page, include_in_schema=False),
        _Elsewhere("/{rest:path}", no_screen),
    ]


def help_folder() -> Path:
    """Returns the folder of the how-to pages, in a checkout or an installed package."""
    package = Path(__file__).resolve().parents[1]
    installed = package / "_data" / "how-to"
    return installed if installed.is_dir() else package.parent / "docs" / "how-to"


class _Elsewhere(Route):
    """The addresses that nothing else has, for those who go there in a browser.

    For all others it is no route: they are told in JSON what is not there.
    """

    def __init__(self, path: str, endpoint: Callable[[Request], Response]) -> None:
        super().__init__(path, endpoint, include_in_schema=False)
        # It takes what no other route takes, and adds no method to the paths of others.
        self.methods = None

    def matches(self, scope: Scope) -> tuple[Match, Scope]:
        """Matches the requests of a browser for a page."""
        if scope["type"] != "http" or not _goes_to_a_page(Request(scope)):
            return Match.NONE, {}
        return super().matches(scope)


def _goes_to_a_page(request: Request) -> bool:
    first = request.url.path.lstrip("/").partition("/")[0]
    return (
        request.method in ("GET", "HEAD")
        and first not in _NO_SCREENS
        and request.headers.get("sec-fetch-mode", "navigate") == "navigate"
        and "text/html" in request.headers.get("accept", "").lower()
    )


def _document_under(root_path: str, request: Request, path: Path) -> Response:
    """Returns the document with the addresses of its files below a path.

    A `<base>` would do the same, but its policy allows none: an injected one would lead the page's
    scripts elsewhere. Addresses relative to the document would lead elsewhere from each screen.
    """
    body = _ADDRESS.sub(rf"\g<1>{root_path}/", path.read_text(encoding="utf-8")).encode()
    headers = {
        **_HEADERS,
        "Cache-Control": "no-cache",
        "Vary": "Accept-Encoding",
        "ETag": f'"{hashlib.sha256(body).hexdigest()[:32]}"',
    }
    if "gzip" in _accepted_encodings(request):
        headers["Content-Encoding"] = "gzip"
        body = gzip.compress(body, mtime=0)
    return Response(body, headers=headers, media_type="text/html")


def _file(request: Request, path: Path, cache: str) -> Response:
    if not path.is_file():
        return Response("There is no such file.\n", 404, media_type="text/plain")
    media_type = mimetypes.guess_type(path.name)[0] or "application/octet-stream"
    headers = {**_HEADERS, "Cache-Control": cache, "Vary": "Accept-Encoding"}
    accepted = _accepted_encodings(request)
    for encoding, suffix in _ENCODINGS:
        stored = path.with_name(path.name + suffix)
        if encoding in accepted and stored.is_file():
            headers["Content-Encoding"] = encoding
            path = stored
            break
    return FileResponse(path, headers=headers, media_type=media_type)


def _accepted_encodings(request: Request) -> set[str]:
    header = request.headers.get("accept-encoding", "")
    return {part.split(";")[0].strip() for part in header.split(",")}
