"""Bird's-eye rasters: images of the surroundings for agents that take images."""
