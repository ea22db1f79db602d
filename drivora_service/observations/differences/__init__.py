"""The differences of two traces."""
