"""What the agents share that were trained here: sight of the way, and following waypoints."""
