"""Actors that follow a path: NPC vehicles and walkers."""
