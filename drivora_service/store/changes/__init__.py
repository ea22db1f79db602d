"""What has changed: the count of changes, and lists by it."""
