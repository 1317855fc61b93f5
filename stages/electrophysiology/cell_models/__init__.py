"""Cell models, one per file, picked by name."""
