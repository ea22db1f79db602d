"""The PPO expert that MetaDrive ships, on the perception of an ego."""
