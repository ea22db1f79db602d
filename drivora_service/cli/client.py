"""A client of the HTTP API, as far as the commands need it."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from types import TracebackType
from typing import Any, Literal, Self

import httpx

from drivora_service.errors import InvalidDocument, Problem, ServiceError

_PREFIX = "/api/v1"
_TIMEOUT_S = 60.0
_PAGE_SIZE = 500


class ServiceClient:
    """Talks to one service; a context manager that closes its connections."""

    def __init__(self, url: str, token: str | None = None) -> None:
        """Prepares a client.

        Args:
            url: Address of the service, such as ``http://127.0.0.1:8000``.
            token: API token; ``None``: the environment's ``DRIVORA_TOKEN``, if any.
        """
        token = os.environ.get("DRIVORA_TOKEN", "") if token is None else token
        headers = {"Authorization": f"Bearer {token}"} if token else {}
        self._url = url
        self._http = httpx.Client(
            base_url=url.rstrip("/") + _PREFIX, headers=headers, timeout=_TIMEOUT_S
        )

    def __enter__(self) -> Self:
        """Returns the client itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Closes the connections."""
        self.close()

    def close(self) -> None:
        """Closes the connections."""
        self._http.close()

    def get(self, path: str, **parameters: object) -> Any:
        """Asks for JSON.

        Raises:
            ServiceError: The service refused or did not answer.
        """
        return self._send("GET", path, params=_given(parameters)).json()

    def download(self, path: str, *, accept: str) -> bytes:
        """Asks for bytes of a media type.

        Raises:
            ServiceError: The service refused or did not answer.
        """
        return self._send("GET", path, headers={"Accept": accept}).content

    def expect_workers(self) -> None:
        """Makes sure that the service can begin runs; what is queued stays queued otherwise.

        Raises:
            ServiceError: It cannot begin runs, or did not answer.
        """
        fault = worker_fault(self._request("GET", "/readyz"))
        if fault:
            raise ServiceError(
                f"the service at {self._url} cannot begin runs: {fault}\n"
                "What is queued there stays queued, and begins once that is mended"
            )

    def validate(
        self, document: str | bytes, *, form: Literal["json", "yaml"] = "json", agent: str = ""
    ) -> Any:
        """Has a scenario checked.

        Args:
            document: The scenario.
            form: Its language.
            agent: Drives every ego; "": as documented.

        Raises:
            InvalidDocument: It cannot be run.
            ServiceError: The service refused or did not answer.
        """
        return self._post("/scenarios:validate", document, form, agent=agent)

    def post_batch(
        self,
        documents: Sequence[str],
        *,
        name: str = "",
        agent: str = "",
        agent_parameters: Sequence[str] = (),
        seed: int | None = None,
        priority: str = "interactive",
    ) -> Any:
        """Queues runs of scenarios.

        Raises:
            InvalidDocument: None of them can be run.
            ServiceError: The service refused or did not answer.
        """
        body = f"[{','.join(documents)}]"
        return self._post(
            "/batches",
            body,
            "json",
            name=name,
            agent=agent,
            agent_parameter=list(agent_parameters),
            seed=seed,
            priority=priority,
        )

    def post_campaign(self, document: str) -> Any:
        """Has the service run a campaign.

        Args:
            document: The campaign as JSON.

        Raises:
            InvalidDocument: It cannot be run.
            ServiceError: The service refused or did not answer.
        """
        return self._post("/campaigns", document, "json")

    def act(self, path: str) -> Any:
        """Asks for something to be done: ``/campaigns/ID:pause``.

        Raises:
            ServiceError: The service refused or did not answer.
        """
        return self._send("POST", path).json()

    def items(self, path: str, **parameters: object) -> Iterator[Any]:
        """Returns all items of a list, page by page.

        Raises:
            ServiceError: The service refused or did not answer.
        """
        token = ""
        while True:
            page = self.get(path, **{"limit": _PAGE_SIZE, **parameters, "page_token": token})
            yield from page["items"]
            token = page["next_page_token"]
            if not token:
                return

    def jobs(self, batch_id: str) -> Iterator[Any]:
        """Returns the jobs of a batch, last to first."""
        return self.items("/jobs", batch=batch_id)

    def _post(self, path: str, body: str | bytes, form: str, **parameters: object) -> Any:
        response = self._send(
            "POST",
            path,
            content=body,
            headers={"Content-Type": f"application/{form}"},
            params=_given(parameters),
        )
        return response.json()

    def _send(self, method: str, path: str, **request: Any) -> httpx.Response:
        response = self._request(method, path, **request)
        if response.is_error:
            raise _refusal(response)
        return response

    def _request(self, method: str, path: str, **request: Any) -> httpx.Response:
        try:
            try:
                return self._http.request(method, path, **request)
            except httpx.RemoteProtocolError:
                # The service closes connections that rest for some seconds; on a busy machine the
                # next request may cross that on its way. To ask again for the same does no harm.
                if method != "GET":
                    raise
                return self._http.request(method, path, **request)
        except httpx.HTTPError as error:
            raise ServiceError(f"the service at {self._url} does not answer: {error}") from error


def worker_fault(readiness: httpx.Response) -> str:
    """Returns why a service cannot begin runs, "" if it can, from what ``/readyz`` answered."""
    if readiness.is_success:
        return ""
    try:
        checks = readiness.json()["checks"]
    except (ValueError, KeyError):
        # Not the service itself, but for example a proxy before it.
        return ""
    return next((c["detail"] for c in checks if c["name"] == "workers" and not c["ok"]), "")


def _given(parameters: dict[str, object]) -> list[tuple[str, str]]:
    """Returns the parameters of a request; a list stands for a parameter that is repeated."""
    return [
        (name, str(value))
        for name, values in parameters.items()
        for value in (values if isinstance(values, list) else [values])
        if value not in (None, "")
    ]


def _refusal(response: httpx.Response) -> InvalidDocument | ServiceError:
    try:
        details = response.json()
    except ValueError:
        details = {}
    problems = tuple(
        Problem(pointer=p["pointer"], code=p["code"], message=p["message"])
        for p in details.get("problems", ())
    )
    if problems:
        return InvalidDocument(problems)
    said = details.get("detail") or response.reason_phrase
    return ServiceError(f"the service refused: {said}", status=response.status_code)
