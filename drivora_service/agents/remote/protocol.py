"""Constants of both sides of the protocol, besides its messages."""

from __future__ import annotations

VERSION = 1
"""Version of ``agent.proto``; both sides send theirs, and reject others."""

ADDRESS_VARIABLE = "DRIVORA_AGENT_ADDRESS"
"""Environment variable with the address of a started ADS: ``unix:PATH``."""

MESSAGE_BYTES = 64 << 20
"""Maximum size of a message."""

MAX_RASTERS = 4
"""Maximum number of images at each step."""

_SERVICE = "/drivora.agents.v1.Agent/"
DESCRIBE, SETUP_ENV, RUN_STEP = (_SERVICE + name for name in ("Describe", "SetupEnv", "RunStep"))
"""Full names of the calls."""
