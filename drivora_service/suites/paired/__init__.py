"""Two batches on the same scenarios: pairs of runs, and what differs between them."""
