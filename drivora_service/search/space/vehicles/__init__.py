"""NPC vehicles of candidates: genes, paths, places and decoding."""
