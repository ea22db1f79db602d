"""Common parts of the agents trained here: view of the way, and following waypoints."""
