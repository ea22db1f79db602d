"""The failures of all campaigns and batches, and the groups that users decide about."""
