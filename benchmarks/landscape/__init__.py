"""The landscape of the search: what small changes of a scenario do to its run."""
