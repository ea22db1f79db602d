"""Traffic laws as signal temporal logic: formulas, the signals they name, and judging by them."""
