"""The planner that simulates proposals along its route and executes the best of them."""
