"""DoppelTest: several egos under the same ADS, evolved to get in one another's way."""
