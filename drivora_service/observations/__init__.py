"""The record of a run: the trace, its file, its hash, its published form and derived geometry."""
