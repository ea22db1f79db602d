"""``drivora run``, ``runs``, ``replay``, ``rejudge`` and ``plot``."""
