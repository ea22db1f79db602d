"""Objectives of the search: scores of a trace, to be minimised."""
