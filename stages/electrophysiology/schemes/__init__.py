"""Schemes in time, one per file, picked by name."""
