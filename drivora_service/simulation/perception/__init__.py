"""What agents perceive of other actors."""
