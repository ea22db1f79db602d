"""``drivora suite``."""
