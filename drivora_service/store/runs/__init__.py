"""Runs and batches: their tables, records, lists, filters and results."""
