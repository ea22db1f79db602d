"""Suites: scenarios with expectations; their gate, comparison, replay and minimisation."""
