"""Routes along lanes: planning, matching, searching, following."""
