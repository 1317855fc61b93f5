"""Laws of the active stress, one per file, picked by name."""
