"""From genes to scenarios: the variations of a seed scenario on its road network."""
