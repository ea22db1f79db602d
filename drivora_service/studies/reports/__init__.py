"""The report of one campaign."""
