"""The self-play driving policy that PufferLib ships, on the perception of an ego."""
