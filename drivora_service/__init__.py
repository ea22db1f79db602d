"""Finds the scenarios in which autonomous driving systems fail, on SUMO."""
