"""The intelligent driver with overtaking: lane changes by MOBIL."""
