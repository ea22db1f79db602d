"""The ADS interface, the catalogue, and the ADSs that are built in."""
