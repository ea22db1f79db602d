"""The models of actors, with their figures."""
