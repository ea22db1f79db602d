"""What authors of plug-ins test theirs with: contract suites and synthetic traces."""
