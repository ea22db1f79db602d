"""The gate of a suite: its document, baseline, limits and decision."""
