"""Loads, one kind per file, picked by ``kind``."""
