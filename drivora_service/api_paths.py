"""Where the HTTP API is: for the API and its clients, which must not import the API."""

from __future__ import annotations

PREFIX = "/api/v1"
