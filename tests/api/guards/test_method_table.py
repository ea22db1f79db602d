from __future__ import annotations

import http.client
from itertools import product
from urllib.parse import urlsplit

from tests.api.conftest import Offline
from tests.api.test_problem_details import is_problem

JOB = "/api/v1/jobs/0"


METHODS = {
    "/api/v1/jobs": "GET, HEAD, POST",
    "/api/v1/batches": "GET, HEAD, POST",
    "/api/v1/campaigns": "GET, HEAD, POST",
    JOB: "GET, HEAD",
    f"{JOB}:cancel": "POST",
    "/api/v1/campaigns/0:resume": "POST",
    "/api/v1/batches:compare": "GET, HEAD",
    "/api/v1/campaigns:compare": "GET, HEAD",
    "/api/v1/scenarios:validate": "POST",
    "/api/v1/scenarios:examples": "GET, HEAD",
    "/api/v1/campaigns:validate": "POST",
    "/api/v1/studies:validate": "POST",
    "/api/v1/networks/tee-town/geometry": "GET, HEAD",
    "/api/v1/healthz": "GET, HEAD",
    "/healthz": "GET, HEAD",
    "/docs": "GET, HEAD",
    "/api/v1/openapi.json": "GET, HEAD",
}


def test_a_refused_method_names_every_allowed_one(offline: Offline) -> None:
    for method, (path, allowed) in product(("DELETE", "OPTIONS", "NONSENSE"), METHODS.items()):
        answer = offline.client.request(method, path)
        assert answer.headers["Allow"] == allowed, (method, path)
        assert allowed in is_problem(answer, 405)["detail"]


def test_an_action_is_not_looked_up_as_a_job(offline: Offline) -> None:
    is_problem(offline.client.get(f"{JOB}:cancel"), 405)
    is_problem(offline.client.post(JOB), 405)
    is_problem(offline.client.post(f"{JOB}:explode"), 404)


def test_a_path_that_ends_in_a_slash_is_another_one(offline: Offline) -> None:
    for path in ("/api/v1/jobs/", "/api/v1/batches/", "/api/v1/jobs/0/", "/healthz/"):
        is_problem(offline.client.get(path), 404)


def test_head_is_get_without_the_body(offline: Offline) -> None:
    for path in ("/healthz", "/api/v1/jobs", "/docs", "/api/v1/jobs/0", "/x"):
        shown, hidden = offline.client.get(path), offline.client.head(path)
        assert hidden.status_code == shown.status_code, path
        assert hidden.headers["Content-Length"] == shown.headers["Content-Length"], path
        assert hidden.content == b""


def test_a_connection_goes_on_after_head(offline: Offline) -> None:
    address = urlsplit(str(offline.client.base_url))
    connection = http.client.HTTPConnection(address.hostname or "", address.port)
    for method in ("HEAD", "GET", "HEAD", "GET"):
        connection.request(method, "/healthz")
        answer = connection.getresponse()
        assert bool(answer.read()) is (method == "GET")
    connection.close()
