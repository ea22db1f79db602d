"""Training agents by imitation: recording an expert, fitting networks, writing their weights."""
