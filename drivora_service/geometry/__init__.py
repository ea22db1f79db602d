"""Plane geometry and array types that every room shares: angles, lines, oriented boxes.

Coordinates are metres; angles are radians, counter-clockwise from east.
"""
