"""The web page: its sources (``web``), its build into the package, and its files as routes."""
