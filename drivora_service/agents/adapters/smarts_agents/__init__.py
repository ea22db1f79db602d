"""Policies trained in the simulator SMARTS, of packages that their users install."""
