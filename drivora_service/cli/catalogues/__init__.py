"""``drivora agents``, ``oracles``, ``testers``, ``laws`` and ``networks``."""
