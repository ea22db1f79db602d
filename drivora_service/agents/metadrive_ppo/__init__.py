"""The PPO expert that MetaDrive ships, driven by what an ego perceives here."""
