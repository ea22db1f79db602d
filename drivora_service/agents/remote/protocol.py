"""What both sides of the protocol must agree on besides its messages."""

from __future__ import annotations

VERSION = 1
"""Of the protocol in ``agent.proto``; both sides say theirs, and refuse another."""

ADDRESS_VARIABLE = "DRIVORA_AGENT_ADDRESS"
"""Environment variable that tells a started ADS where to listen: ``unix:PATH``."""

MESSAGE_BYTES = 64 << 20
"""Size of a message that either side takes."""

_SERVICE = "/drivora.agents.v1.Agent/"
DESCRIBE, SETUP_ENV, RUN_STEP = (_SERVICE + name for name in ("Describe", "SetupEnv", "RunStep"))
"""Full names of the calls."""
