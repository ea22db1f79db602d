"""The interface of agents, the catalogue, and the built-in agents."""
