"""Replay: a stored run and its repetition, compared."""
