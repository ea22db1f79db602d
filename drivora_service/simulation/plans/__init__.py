"""The plan of an episode: its actors, paths, lights, and their arrays."""
