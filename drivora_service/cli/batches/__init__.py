"""``drivora compare``."""
