"""The confinement of an ADS's process: account and limits."""

from __future__ import annotations

import json
import os
import pwd
from dataclasses import asdict, dataclass
from pathlib import Path

from drivora_service.errors import ConfigurationError

_GIB = 1 << 30

_PASSED_ON = frozenset(
    {
        "HOME", "LANG", "LANGUAGE", "LD_LIBRARY_PATH", "LOGNAME", "PATH", "PYTHONDONTWRITEBYTECODE",
        "PYTHONHASHSEED", "PYTHONUNBUFFERED", "SHELL", "SSL_CERT_DIR", "SSL_CERT_FILE", "TERM",
        "TZ", "USER",
    }
)  # fmt: skip
_PASSED_ON_FAMILIES = ("CUDA_", "LC_", "MKL_", "NUMBA_", "NVIDIA_", "OMP_", "OPENBLAS_")


@dataclass(frozen=True, slots=True, kw_only=True)
class Confinement:
    """Limits of the process of an ADS and of all processes that it starts.

    Attributes:
        user: Id of its user account; ``None`` for that of the worker.
        group: Id of the group, if there is a user.
        memory_bytes: Maximum resident memory of all its processes, beyond which it is ended.
        file_bytes: Maximum size of a written file.
        files: Maximum number of open files of a process.
        processes: Maximum processes and threads of the user; applies only with its own user,
            as it counts all processes of the user.
    """

    user: int | None = None
    group: int | None = None
    memory_bytes: int = 4 * _GIB
    file_bytes: int = _GIB
    files: int = 4096
    processes: int = 4096

    def text(self) -> str:
        """Returns the JSON text for the guard."""
        return json.dumps(asdict(self))


def account(name: str) -> tuple[int, int]:
    """Returns the ids of a user account for ADSs and of its group.

    Raises:
        ConfigurationError: There is no such account, it is that of the service, or the service may
            not start processes under another one.
    """
    try:
        found = pwd.getpwnam(name)
    except KeyError:
        raise ConfigurationError(
            f"DRIVORA_AGENT_USER: found {name!r}, which is no account of this machine; make it "
            f"(`useradd --system --no-create-home {name}`) or name another"
        ) from None
    if os.geteuid() != 0:
        raise ConfigurationError(
            "DRIVORA_AGENT_USER: only a service that runs as root can start ADSs under another "
            f"account; this one runs as user {os.geteuid()}. Leave it empty, or start as root"
        )
    if found.pw_uid == 0:
        raise ConfigurationError(
            f"DRIVORA_AGENT_USER: found {name!r}, the account of the service; name one of its own"
        )
    return found.pw_uid, found.pw_gid


def variables_for(
    own: dict[str, str], *, scratch: Path, settings: tuple[str, ...]
) -> dict[str, str]:
    """Returns the environment variables of the worker that are passed to an ADS.

    Only those that programs need to run: the rest may be secret.

    Args:
        own: Variables of the worker.
        scratch: Writable folder of the ADS.
        settings: Further names that the operator allows.
    """
    kept = {
        name: value
        for name, value in own.items()
        if name in _PASSED_ON or name.startswith(_PASSED_ON_FAMILIES) or name in settings
    }
    return {**kept, "TMPDIR": str(scratch)}
