"""What the scenarios of a campaign cover: roads, laws, genes, kinds of scenarios."""
