"""The places of trace files, in folders or in a storage of objects."""
