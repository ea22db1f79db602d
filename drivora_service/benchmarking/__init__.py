"""The benchmark of the ADSs: its fixed scenarios, and the cards of agents."""
