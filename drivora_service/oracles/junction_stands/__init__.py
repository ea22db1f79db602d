"""Stays of egos in junctions: where, for which reasons, and which vehicles wait for them."""
