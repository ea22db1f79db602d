"""The self-play driving policy that PufferLib ships, driven by what an ego perceives here."""
