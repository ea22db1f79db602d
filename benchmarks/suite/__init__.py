"""All measurements of time as one suite, with one result and one page."""
