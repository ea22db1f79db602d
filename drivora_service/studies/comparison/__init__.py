"""Campaigns and the campaigns of studies, compared by measures and curves."""
