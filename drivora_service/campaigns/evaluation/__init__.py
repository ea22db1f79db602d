"""Evaluators: how the candidates of a campaign are run."""
