"""Reports of a suite: HTML, JUnit XML, CSV, Markdown."""
