"""The intelligent driver that overtakes: lane changes by MOBIL."""
