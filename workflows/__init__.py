"""Whole experiments: plans, command line, exports."""
