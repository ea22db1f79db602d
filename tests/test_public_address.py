from __future__ import annotations

import pytest
from starlette.routing import Route

from drivora_service.dashboard.page import SECTIONS, page_routes
from drivora_service.errors import ConfigurationError
from drivora_service.public_address import OWN_NAMES
from drivora_service.settings import load_settings


@pytest.mark.parametrize(
    ("given", "read"),
    [
        ("", ""),
        ("/", ""),
        ("/drivora", "/drivora"),
        ("/drivora/", "/drivora"),
        ("/tools/drivora-2.0/", "/tools/drivora-2.0"),
        ("/tools/runs", "/tools/runs"),
    ],
)
def test_a_root_path_has_no_slash_at_its_end(given: str, read: str) -> None:
    assert load_settings(root_path=given).resolved_root_path == read


@pytest.mark.parametrize(
    "given",
    [
        *("drivora", "//host/drivora", "/a//b", "/../b", "/a/..", "/.hidden", "/a b", "/a%2Fb"),
        *('/"><script>', "/ä", "https://host/drivora", "/a?b", "/a#b", "/a\n", "/a;b", "/\\host"),
    ],
)
def test_what_is_no_path_is_refused(given: str) -> None:
    with pytest.raises(ConfigurationError, match=r"DRIVORA_ROOT_PATH: .*such as /drivora"):
        load_settings(root_path=given)


@pytest.mark.parametrize("name", sorted(OWN_NAMES))
def test_a_path_of_the_service_itself_is_refused(name: str) -> None:
    with pytest.raises(
        ConfigurationError, match=f"DRIVORA_ROOT_PATH: /{name} is a path of the service itself"
    ):
        load_settings(root_path=f"/{name}/x")


def test_the_names_are_those_of_the_page() -> None:
    routes = {route.path for route in page_routes() if isinstance(route, Route)}
    first = {path.split("/")[1] for path in routes} - {"", "{rest:path}"}
    assert first <= OWN_NAMES
    assert set(SECTIONS) <= OWN_NAMES


def test_the_path_may_come_with_the_public_address(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DRIVORA_PUBLIC_URL", "https://host:8443/tools/drivora/")
    settings = load_settings()
    assert settings.public_url == "https://host:8443/tools/drivora"
    assert settings.resolved_root_path == "/tools/drivora"
    assert load_settings(root_path="/tools/drivora/").resolved_root_path == "/tools/drivora"
    with pytest.raises(ConfigurationError) as wrong:
        load_settings(root_path="/other")
    assert str(wrong.value) == (
        "DRIVORA_ROOT_PATH is /other but DRIVORA_PUBLIC_URL is https://host:8443/tools/drivora: "
        "end the address with that path, or leave out one of them"
    )


def test_a_public_address_of_https_is_known_by_its_scheme() -> None:
    assert load_settings(public_url="HTTPS://Host/drivora").public_url == "https://Host/drivora"


@pytest.mark.parametrize(
    "given",
    [
        *("host/drivora", "ftp://host/", "https://", "https://host/?a=b", "https://host/api"),
        *("https://host/?", "https://host/#", "https://host/drivora?", "https://host:port/"),
        *("https://host:70000/", "https://[::1/", " https://host/", "https://host/dri\nvora"),
        *("https://ho st/", "https://host/\t", "https://host\\@other/"),
    ],
)
def test_what_is_no_public_address_is_refused(given: str) -> None:
    with pytest.raises(ConfigurationError, match="DRIVORA_PUBLIC_URL: "):
        load_settings(public_url=given)
