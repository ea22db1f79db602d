"""The planner that simulates proposals along its route and drives the best of them."""
