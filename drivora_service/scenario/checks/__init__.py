"""Checks of documents and scenarios, against networks and catalogues."""
