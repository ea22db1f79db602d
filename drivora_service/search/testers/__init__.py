"""The testing methods, one module or folder each."""
