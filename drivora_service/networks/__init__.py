"""Road networks: reading, importing, routing on them and finding places in them."""
