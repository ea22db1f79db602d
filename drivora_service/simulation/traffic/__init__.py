"""SUMO's side of an episode: its vehicles, stand-ins, background traffic."""
