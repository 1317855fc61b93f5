"""Materials, one per file, picked by name."""
