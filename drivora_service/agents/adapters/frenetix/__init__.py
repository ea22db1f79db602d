"""Trajectories sampled in the Frenet frame by the package ``frenetix``."""
