"""Minimisations: their table, records and repository."""
