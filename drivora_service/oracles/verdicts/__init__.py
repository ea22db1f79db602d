"""What follows from verdicts: accountability, facts of failures, JSON, marks."""
