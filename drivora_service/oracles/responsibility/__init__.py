"""Responsibility for a collision: evidence from the trace, and a table of rules."""
