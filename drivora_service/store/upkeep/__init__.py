"""Work on a whole store: backup, pruning, retention, verification, figures."""
