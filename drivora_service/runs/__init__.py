"""Values: the specification of a run, its life cycle, its report."""
