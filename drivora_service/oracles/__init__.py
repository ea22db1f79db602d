"""The rules: each judges a trace and says whether, when, where and by whom it was broken."""
