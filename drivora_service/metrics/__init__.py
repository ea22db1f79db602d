"""Measures that describe a judged trace."""
