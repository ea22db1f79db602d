"""The node of the cluster on this machine, without which a driver of Ray cannot connect."""

from __future__ import annotations

from drivora_service.execution.ray.messages import NotConnected

_JOINING_S = 15.0
"""Seconds for which a node that is being started is waited for; Ray itself waits for a minute."""

_NO_NODE = "No node info found"
"""What Ray says if no process of a node on this machine belongs to the cluster."""


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
        if _NO_NODE in str(error):
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
    elif is_reached:
        reason = (
            f"cannot be used: {reason}; this machine must be a node of it ({joining}), with the "
            "same version of Ray"
        )
    else:
        reason = f"cannot be reached: {reason}; start it, or correct DRIVORA_RAY_ADDRESS"
    return NotConnected(reason=reason)
