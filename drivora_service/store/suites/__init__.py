"""Suites that were run, with the decisions of their gates."""
