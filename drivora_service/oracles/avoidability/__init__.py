"""Whether a collision could have been avoided, by replay of the others' recorded motion."""
