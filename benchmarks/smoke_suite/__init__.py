"""The making of the smoke suite: a search for failures of several ADSs, and a choice."""
