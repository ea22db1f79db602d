"""What a run recorded: the trace, its file, its hash, its published shape and its geometry."""
