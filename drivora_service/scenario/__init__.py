"""What is to be driven: the OpenScenario document, its model, validation, importers and seeds."""
