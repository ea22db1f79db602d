"""The reactive planner of CommonRoad, from the package ``commonroad-reactive-planner``."""
