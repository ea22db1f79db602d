"""What is to be run, how its life goes, and what came of it."""
