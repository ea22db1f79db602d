"""Searching for failures: the gene space, the operators, and the testing methods as ask/tell."""
