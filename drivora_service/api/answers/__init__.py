"""What endpoints read from requests, and how they make their answers."""
