"""DriveFuzz (Kim et al. 2022)."""
