"""The campaign document: its model, reading, schema, and what its names mean."""
