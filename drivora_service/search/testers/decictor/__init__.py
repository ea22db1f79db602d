"""Decictor."""
