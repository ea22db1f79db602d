"""Oracles, each of which judges a trace: whether, when, where and by which ego it is violated."""
