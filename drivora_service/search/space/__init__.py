"""From genes to scenarios: what a seed scenario on its road network can be varied to."""
