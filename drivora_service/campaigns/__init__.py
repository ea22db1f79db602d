"""Campaigns: a tester, an ADS, a seed scenario and a budget, from the first run to the report."""
