"""Studies: what campaigns come to, alone and compared with others."""
