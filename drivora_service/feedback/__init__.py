"""Objectives of the search: each scores a trace, to be minimised."""
