"""The queue: submitting runs, leasing them to owners, and writing their ends."""
