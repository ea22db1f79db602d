"""What a driver of Ray cannot connect without: a node on this machine, and the cluster's token."""

from __future__ import annotations

from drivora_service.execution.ray.ray_messages import NotConnected

_JOINING_S = 15.0
"""Seconds for which a node that is being started is waited for; Ray itself waits for a minute."""

_NO_NODE = "No node info found"
"""What Ray says if no process of a node on this machine belongs to the cluster."""

_TOKEN_ERROR = "AuthenticationError"
"""The class of Ray's errors of a token that is missing or wrong."""


def require_token() -> None:
    """Checks that there is a token if Ray is to use one, for without it Ray ends the process.

    Raises:
        AuthenticationError: ``RAY_AUTH_MODE`` asks for a token, and there is none.
    """
    try:
        from ray._private.authentication.authentication_token_setup import (
            ensure_token_if_auth_enabled,
        )
    except ImportError:
        # No public function of Ray: other versions may have another one.
        return
    ensure_token_if_auth_enabled(create_token_if_missing=False)


def require_local_node(address: str) -> None:
    """Checks that this machine is a node of the cluster; does nothing where Ray does not tell.

    Args:
        address: Address of a cluster that answers, HOST:PORT, or ``auto``, which is not checked.

    Raises:
        RuntimeError: It is none.
    """
    if address == "auto":
        return
    try:
        from ray._private.services import get_node_to_connect_for_driver
        from ray._raylet import GcsClient  # type: ignore[attr-defined] # not in its stub

        get_node_to_connect_for_driver(GcsClient(address=address), timeout_seconds=int(_JOINING_S))
    except Exception as error:
        if _NO_NODE in str(error) or _is_token_error(error):
            raise
        # A function of Ray that is not public: other versions may have another one. What is wrong
        # otherwise, the connection itself finds.


def explain(error: Exception, address: str, *, is_reached: bool) -> NotConnected:
    """Returns the cause of a failed connection and what to do.

    Args:
        error: What was raised.
        address: Address of the cluster.
        is_reached: Whether something answers there.
    """
    joining = f"`ray start --address={address} --num-cpus=0`"
    if address == "auto":
        joining = "`ray start --address=HOST:PORT --num-cpus=0`"
    reason = (str(error).strip() or type(error).__name__).splitlines()[0].rstrip(".")
    if _NO_NODE in f"{error} {error.__cause__}":
        reason = f"answers, but this machine is no node of it: run {joining} here"
    elif _is_token_error(error) or _is_token_error(error.__cause__):
        reason = (
            "cannot be used: its token is missing or wrong; set RAY_AUTH_MODE=token and the same "
            "RAY_AUTH_TOKEN as on its nodes"
        )
    elif is_reached:
        reason = (
            f"cannot be used: {reason}; this machine must be a node of it ({joining}), with the "
            "same version of Ray"
        )
    else:
        # Of "auto", Ray does not tell whether the token is wrong.
        mending = "start it, or correct DRIVORA_RAY_ADDRESS"
        if address == "auto":
            mending = "start it, correct DRIVORA_RAY_ADDRESS, or set its RAY_AUTH_TOKEN"
        reason = f"cannot be reached: {reason}; {mending}"
    return NotConnected(reason=reason)


def _is_token_error(error: BaseException | None) -> bool:
    # By the name: Ray is imported by nothing that may be of use without it.
    return _TOKEN_ERROR in type(error).__name__
