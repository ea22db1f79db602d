"""What every request passes: limits, origin, tokens, sessions, idempotency, compression."""
