"""``drivora campaign``."""
