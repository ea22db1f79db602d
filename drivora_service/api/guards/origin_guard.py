"""Keeps web pages of other sites, and clients of other machines, from a service without tokens.

A page in the user's browser can send simple requests to any local port, and can have a name of its
own resolve to 127.0.0.1. So requests that change something must not come from another site, and,
where no token is needed, the ``Host`` header must name this machine. A proxy on this machine makes
a service on loopback reachable from the network: what comes through one needs a token.
"""

from __future__ import annotations

import ipaddress
from collections.abc import Callable
from http import HTTPStatus

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from drivora_service.api.guards.host_names import is_origin_of, read_host
from drivora_service.api.guards.path_prefix import public_path
from drivora_service.api.problem_details import problem_response

_SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})
_OWN_SITE = frozenset({"same-origin", "none"})
"""Values of ``Sec-Fetch-Site`` of requests from a page of the service, or from no page."""

_FORWARDED = frozenset(
    {
        "forwarded",
        "forwarded-for",
        "via",
        "cdn-loop",
        "client-ip",
        "true-client-ip",
        "proxy-client-ip",
        "wl-proxy-client-ip",
        "x-azure-clientip",
        "x-client-ip",
        "x-cluster-client-ip",
        "x-proxyuser-ip",
        "x-real-ip",
        "cf-connecting-ip",
        "fastly-client-ip",
    }
)
_FORWARDED_PREFIXES = ("x-forwarded", "x-original-", "x-envoy-")
"""Of headers that proxies add."""

_MAKE_A_TOKEN = (
    "`drivora tokens create NAME` makes an API token; every request needs one from then on, "
    "and may come from anywhere"
)


class OriginGuard:
    """ASGI middleware that refuses cross-site requests (403) and, without tokens, remote ones."""

    def __init__(self, app: ASGIApp, *, is_open: Callable[[], bool]) -> None:
        """Creates the middleware around an application.

        Args:
            app: What answers.
            is_open: Returns whether requests need no token at the moment.
        """
        self._app = app
        self._is_open = is_open

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serves a request."""
        if scope["type"] == "http":
            refused = self._refusal(scope)
            if refused is not None:
                status, detail = refused
                response = problem_response(status, detail, instance=public_path(scope))
                await response(scope, receive, send)
                return
        await self._app(scope, receive, send)

    def _refusal(self, scope: Scope) -> tuple[HTTPStatus, str] | None:
        """Returns why a request is refused, or ``None``."""
        headers = Headers(scope=scope)
        host = headers.get("host", "")
        if host and read_host(host) is None:
            return HTTPStatus.BAD_REQUEST, f"{host[:100]!r} is no host with an optional port"
        if self._is_open():
            refused = _remote_refusal(scope, headers, host)
            if refused is not None:
                return refused
        if scope["method"] not in _SAFE_METHODS and _is_cross_site(headers, host):
            return HTTPStatus.FORBIDDEN, "requests from pages of other sites are refused"
        return None


def _remote_refusal(scope: Scope, headers: Headers, host: str) -> tuple[HTTPStatus, str] | None:
    """Returns why a request without a token does not come from this machine, or ``None``."""
    by = next((name for name in headers if _is_of_a_proxy(name)), None)
    if by is not None:
        return (
            HTTPStatus.FORBIDDEN,
            "this service has no API tokens and answers to its own machine only; this request came "
            f"through a proxy (header {by[:60]!r}). " + _MAKE_A_TOKEN,
        )
    if scope["http_version"] == "1.0":
        # nginx that is given no more than `proxy_pass` asks like this, with the service's own
        # address as the host and no header that shows the proxy.
        return (
            HTTPStatus.FORBIDDEN,
            "this service has no API tokens and answers to its own machine only; this request came "
            "by HTTP/1.0, as through nginx. Use HTTP/1.1 on this machine. " + _MAKE_A_TOKEN,
        )
    named = read_host(host)
    if named is None or not named.is_local:
        return (
            HTTPStatus.MISDIRECTED_REQUEST,
            f"this service has no API tokens and answers to localhost only, not to {host[:100]!r}. "
            + _MAKE_A_TOKEN,
        )
    client = scope.get("client")
    if client is not None and not _is_loopback(client[0]):
        return (
            HTTPStatus.FORBIDDEN,
            "this service has no API tokens and answers to its own machine only. " + _MAKE_A_TOKEN,
        )
    return None


def _is_loopback(address: str) -> bool:
    try:
        found = ipaddress.ip_address(address)
    except ValueError:
        return False
    mapped = found.ipv4_mapped if isinstance(found, ipaddress.IPv6Address) else None
    return (mapped or found).is_loopback


def _is_of_a_proxy(name: str) -> bool:
    # Some programs take both for the same header.
    lower = name.lower().replace("_", "-")
    return lower in _FORWARDED or lower.startswith(_FORWARDED_PREFIXES)


def _is_cross_site(headers: Headers, host: str) -> bool:
    if headers.get("sec-fetch-site", "none") not in _OWN_SITE:
        return True
    origin = headers.get("origin")
    return origin is not None and not is_origin_of(origin, host)
