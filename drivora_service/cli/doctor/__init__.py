"""``drivora doctor``: checks of an installation, each independent of the others."""
