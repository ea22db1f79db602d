"""Tools for testing plug-ins: contract suites and synthetic traces."""
