"""``drivora failures`` and ``drivora minimize``."""
