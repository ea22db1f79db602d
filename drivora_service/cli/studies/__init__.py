"""``drivora study``."""
