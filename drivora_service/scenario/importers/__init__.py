"""Readers of scenarios that were written for other tools."""
