"""Searching for failures: the gene space, the operators, and the testers as ask/tell."""
