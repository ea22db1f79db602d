"""The search of a campaign: engine, confirmation, and groups of failures."""
