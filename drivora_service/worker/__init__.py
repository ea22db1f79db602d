"""The worker's side of a run: simulate, judge, measure, and report, in a process of its own."""
