"""Conflicts of an ego with actors that have the right of way, and the actors that it hinders."""
