"""Tension laws, one per file, picked by name."""
