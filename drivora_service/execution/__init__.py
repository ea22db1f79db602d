"""Running many runs at once, on workers that may die."""
