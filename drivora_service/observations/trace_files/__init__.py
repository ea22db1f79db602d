"""A trace as bytes: its file, header, stream, hash and storage."""
