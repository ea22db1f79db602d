"""The benchmark of the ADSs: its fixed scenarios, and the cards that come of their runs."""
