"""Bird's-eye images for agents that take images."""
