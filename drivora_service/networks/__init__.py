"""Road networks: reading, importing, routing and locating places."""
