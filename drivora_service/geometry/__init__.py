"""Shared plane geometry and array types: angles, lines, oriented boxes.

Coordinates are metres; angles are radians, counter-clockwise from east.
"""
