"""DoppelTest: several egos with the same ADS, evolved to conflict with one another."""
