"""Limits of the system that are too small for a process which runs scenarios."""

from __future__ import annotations

import errno
import resource

from drivora_service.errors import ConfigurationError

_LEAST_DESCRIPTORS = 64
"""Open files of a service with one worker and a few clients (40 were counted)."""
_LEAST_ADDRESS_SPACE = 1536 << 20
"""Bytes of address space of the largest process, which the libraries take (1.4 GiB were seen)."""

_NO_THREAD = "can't start new thread"
"""Text of Python's error, which has no type of its own."""
_SHORT = (errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.EAGAIN)


def check_process_limits() -> None:
    """Refuses limits with which nothing can be simulated; called before any process is started.

    Raises:
        ConfigurationError: A limit is too small.
    """
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    if most != resource.RLIM_INFINITY and most < _LEAST_DESCRIPTORS:
        raise ConfigurationError(
            f"only {most} files may be open at once, and at least {_LEAST_DESCRIPTORS} are needed: "
            "raise the limit (`ulimit -n 4096`; LimitNOFILE= of a systemd unit)"
        )
    space, _ = resource.getrlimit(resource.RLIMIT_AS)
    if space != resource.RLIM_INFINITY and space < _LEAST_ADDRESS_SPACE:
        raise ConfigurationError(
            f"only {space >> 20} MiB of address space are allowed, and at least "
            f"{_LEAST_ADDRESS_SPACE >> 20} MiB are needed: raise the limit (`ulimit -v unlimited`; "
            "LimitAS= of a systemd unit); DRIVORA_MEMORY_LIMIT_MB limits what a worker uses"
        )


def describe_shortage(error: BaseException) -> str:
    """Returns the message for an error for want of files, processes or memory; "" for others."""
    advice = (
        "a limit of this process is too small (`ulimit -a` shows them: open files -n, processes "
        "-u, address space -v), or the machine has no more; raise it, or use fewer --workers"
    )
    if isinstance(error, MemoryError):
        return f"there is not enough memory: {advice}"
    if isinstance(error, RuntimeError) and str(error) == _NO_THREAD:
        return f"no more threads or processes can be started: {advice}"
    if isinstance(error, OSError) and error.errno in _SHORT:
        return f"{error.strerror}: {advice}"
    return ""
