"""Who is responsible for a collision: evidence from the trace, and a table of rules on it."""
