"""Locks on data folders, files and pieces of long work."""
