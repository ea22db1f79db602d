"""Adversaries that act during a run: their actions, their view, their reward, and the game."""
