"""BehAVExplor: fuzzing guided by the diversity of the ego's behaviour."""
