"""The settings of an installation, read from the environment (``DRIVORA_…``).

Only the composition root and the command line read settings; every other room gets values.
"""

from __future__ import annotations

import ipaddress
import os
from pathlib import Path
from typing import Literal, Self

from pydantic import Field, ValidationError, field_validator, model_validator
from pydantic_core import ErrorDetails
from pydantic_settings import BaseSettings, SettingsConfigDict

from drivora_service.errors import ConfigurationError
from drivora_service.public_address import path_of, read_public_url, read_root_path


class Settings(BaseSettings):
    """The settings of one service. Every field is also an environment variable.

    ``DRIVORA_DATA_DIR=/var/lib/drivora DRIVORA_WORKERS=8 drivora serve`` sets two of them.
    """

    model_config = SettingsConfigDict(env_prefix="DRIVORA_", frozen=True)

    data_dir: Path = Field(
        default=Path("drivora-data"),
        description="Folder of the database, the traces, imported networks and API tokens.",
    )
    agents_dir: Path | None = Field(
        default=None,
        description="Folder of installed agents and of manifests (NAME/agent.yaml); "
        "unless given: `agents` in the data folder.",
    )
    laws_dir: Path | None = Field(
        default=None,
        description="Folder of your traffic laws (FILE.yaml); unless given: `laws` in the data "
        "folder. They are read when a service or command starts.",
    )
    database_url: str = Field(
        default="",
        # It may hold a password.
        repr=False,
        description="Address of the database, of SQLite or PostgreSQL; empty: SQLite in the data "
        "folder.",
    )
    traces_url: str = Field(
        default="",
        description="Storage of the traces, as an address of fsspec such as s3://bucket/folder; "
        "empty: the data folder.",
    )
    host: str = Field(default="127.0.0.1", description="Address to listen on.")
    port: int = Field(default=8000, ge=0, le=65535, description="Port; 0 picks a free one.")
    public_url: str = Field(
        default="",
        description="Public address of the service behind a proxy, such as "
        "https://host/drivora; its path is that of DRIVORA_ROOT_PATH.",
    )
    root_path: str = Field(
        default="",
        description="Path that the service is under behind a proxy, such as /drivora; empty: that "
        "of the public address, or the root of the host.",
    )
    require_tokens: bool = Field(
        default=False,
        description="Require an API token on loopback also if none was made; the service then "
        "does not start without one.",
    )
    workers: int = Field(
        default_factory=lambda: os.cpu_count() or 1,
        ge=1,
        le=1024,
        description="Worker processes, on a Ray cluster of each node; one run at a time each.",
    )
    executor: Literal["local", "ray"] = Field(
        default="local",
        description="Where runs are performed: local: on this machine; ray: on the nodes of a Ray "
        "cluster, with the extra `cluster`.",
    )
    ray_address: str = Field(
        default="auto",
        description="Address of the Ray cluster, HOST:PORT; auto: the one that this machine "
        "belongs to.",
    )
    runs_per_worker: int = Field(
        default=2000, ge=1, description="Runs after which a worker process is replaced."
    )
    wall_time_limit_s: float = Field(
        default=600.0, gt=0, description="Seconds of wall time after which a run is ended."
    )
    agent_deadline_s: float = Field(
        default=10.0, gt=0, description="Seconds of wall time that one call of an agent may take."
    )
    agent_user: str = Field(
        default="",
        description="Account of ADSs in processes of their own; needs a service that runs as root. "
        "Empty: that of the service.",
    )
    agent_memory_mb: int = Field(
        default=4096,
        ge=64,
        description="Memory of an ADS in a process of its own with all that it starts, MiB, beyond "
        "which it is ended.",
    )
    memory_limit_mb: int = Field(
        default=2048, ge=256, description="Memory of a worker, MiB, beyond which it is ended."
    )
    drain_s: float = Field(
        default=30.0,
        ge=0,
        description="Seconds for which running runs may end when the service is stopped; the "
        "others go back to the queue.",
    )
    queue_limit: int = Field(
        default=100_000, ge=1, description="Queued runs beyond which new ones are refused (429)."
    )
    max_body_mb: float = Field(
        default=32.0, gt=0, description="Size of a request body, MiB, beyond which it is refused."
    )
    max_network_mb: float = Field(
        default=64.0,
        gt=0,
        description="Size of a file that a road network is imported from, MiB, beyond which it is "
        "refused.",
    )
    max_batch_items: int = Field(
        default=10_000, ge=1, description="Greatest number of scenarios in one batch."
    )
    max_client_connections: int | None = Field(
        default=None,
        ge=1,
        description="Connections of one address at once; a further one ends the oldest without a "
        "request, or is refused. Unset: half of all that the service takes.",
    )
    max_client_bodies: int = Field(
        default=64,
        ge=1,
        le=256,
        description="Requests of one address whose bodies are waited for at the same moment; of "
        "more, the one that was waited for longest is refused (503).",
    )
    head_deadline_s: float = Field(
        default=20.0, gt=0, description="Seconds in which the head of a request must arrive (408)."
    )
    body_deadline_s: float = Field(
        default=20.0,
        gt=0,
        description="Seconds for which a client may send nothing of a body that it has announced, "
        "and after which it must have sent 16 KiB/s (408).",
    )
    campaigns_at_once: int = Field(
        default=4,
        ge=1,
        le=1024,
        description="Number of campaigns that run at once, each in a process; others wait.",
    )
    campaign_memory_mb: int = Field(
        default=4096,
        ge=512,
        le=1 << 30,
        description="Memory of a campaign's process with all that its tester starts, MiB, beyond "
        "which the campaign fails.",
    )
    tester_deadline_s: float = Field(
        default=600.0,
        gt=0,
        description="Seconds that one call of a tester may take, beyond which its campaign fails.",
    )
    retain_passed_traces_days: float | None = Field(
        default=None,
        ge=0,
        description="Days for which traces of runs without a violation are kept; unset: for ever.",
    )
    retain_passed_runs_days: float | None = Field(
        default=None, ge=0, description="Days for which those runs are kept; unset: for ever."
    )
    retain_failing_traces_days: float | None = Field(
        default=None,
        ge=0,
        description="Days for which traces of runs that failed are kept; unset: for ever.",
    )
    retain_failing_runs_days: float | None = Field(
        default=None, ge=0, description="Days for which those runs are kept; unset: for ever."
    )
    retain_campaign_traces_days: float | None = Field(
        default=None,
        ge=0,
        description="Days after the end of a campaign for which traces of its failures are kept, "
        "except the first of each kind and group; unset: for ever.",
    )
    log_format: Literal["console", "json"] = Field(
        default="console", description="Format of log lines."
    )
    log_level: Literal["debug", "info", "warning", "error"] = Field(
        default="info", description="Least level of log lines."
    )

    @field_validator("root_path")
    @classmethod
    def _check_root_path(cls, given: str) -> str:
        return read_root_path(given)

    @field_validator("public_url")
    @classmethod
    def _check_public_url(cls, given: str) -> str:
        return read_public_url(given)

    @model_validator(mode="after")
    def _check_paths_agree(self) -> Self:
        if self.public_url and self.root_path and path_of(self.public_url) != self.root_path:
            raise ValueError(
                f"DRIVORA_ROOT_PATH is {self.root_path} but DRIVORA_PUBLIC_URL is "
                f"{self.public_url}: end the address with that path, or leave out one of them"
            )
        return self

    @property
    def resolved_root_path(self) -> str:
        """Path that the service is under, without a slash at its end; "": the host's root."""
        return self.root_path or path_of(self.public_url)

    @property
    def resolved_database_url(self) -> str:
        """The database's address, with the default filled in."""
        return self.database_url or f"sqlite:///{self.data_dir.resolve() / 'drivora.sqlite3'}"

    @property
    def workers_per_node(self) -> int | None:
        """Worker processes of each node of a Ray cluster; ``None``: one a CPU of the node."""
        return self.workers if "workers" in self.model_fields_set else None

    @property
    def traces_dir(self) -> Path:
        """Folder of the traces."""
        return self.data_dir / "traces"

    @property
    def imported_networks_dir(self) -> Path:
        """Folder of imported networks."""
        return self.data_dir / "networks"

    @property
    def agents_folder(self) -> Path:
        """Folder of installed agents and of the operator's manifests, absolute."""
        return (self.agents_dir or self.data_dir / "agents").resolve()

    @property
    def laws_folder(self) -> Path:
        """Folder of the user's traffic laws, absolute."""
        return (self.laws_dir or self.data_dir / "laws").resolve()

    @property
    def campaigns_dir(self) -> Path:
        """Folder of the campaigns' files: the traces of their failures."""
        return self.data_dir / "campaigns"

    @property
    def tokens_path(self) -> Path:
        """File of the hashed API tokens."""
        return self.data_dir / "tokens.json"

    @property
    def sessions_path(self) -> Path:
        """File of the hashed sessions of web pages."""
        return self.data_dir / "sessions.json"

    @property
    def listens_on_loopback(self) -> bool:
        """Whether only this machine can reach the service."""
        if self.host == "localhost":
            return True
        try:
            return ipaddress.ip_address(self.host).is_loopback
        except ValueError:
            return False

    @property
    def always_needs_tokens(self) -> bool:
        """Whether a token is needed also before the first one was made."""
        return self.require_tokens or not self.listens_on_loopback


def load_settings(**overrides: object) -> Settings:
    """Reads the environment; ``overrides`` that are not ``None`` take precedence.

    Raises:
        ConfigurationError: Values cannot be used; every one is named.
    """
    given = {name: value for name, value in overrides.items() if value is not None}
    try:
        return Settings(**given)  # type: ignore[arg-type] # checked by pydantic as it comes in
    except ValidationError as error:
        raise ConfigurationError("\n".join(map(_problem, error.errors()))) from error


def _problem(details: ErrorDetails) -> str:
    is_own = details["type"] == "value_error"
    message = str(details["ctx"]["error"]) if is_own else details["msg"]
    if not details["loc"]:
        # It is about several settings, and names them.
        return message
    name = "_".join(map(str, details["loc"])).upper()
    return f"DRIVORA_{name}: {message} (found {details['input']!r})"
