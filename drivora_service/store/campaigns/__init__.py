"""Campaigns and studies: their tables, records, evaluations and failures."""
