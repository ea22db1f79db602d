"""Scenarios: the OpenScenario document, its model, validation, importers and seeds."""
