"""``drivora validate``, ``seeds``, ``schema`` and ``examples``, and scenario files."""
