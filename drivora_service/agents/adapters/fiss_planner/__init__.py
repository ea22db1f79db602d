"""Sampling-based planners in the Frenet frame, from the package ``fiss-planner``."""
