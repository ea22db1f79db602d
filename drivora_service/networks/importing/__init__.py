"""Importing road networks from files, some of which are not trusted."""
