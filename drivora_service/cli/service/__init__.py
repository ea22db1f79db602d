"""``drivora serve``, ``store``, ``tokens``, ``demo`` and ``export``."""
