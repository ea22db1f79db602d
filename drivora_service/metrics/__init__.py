"""Metrics of a judged run."""
