"""Throughput against the number of slots, of the service and of a campaign."""
