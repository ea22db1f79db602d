"""The search for scenes on which a study of methods can tell something."""
