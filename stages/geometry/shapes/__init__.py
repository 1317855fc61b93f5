"""Shapes of a film at rest, one per file, picked by ``name``."""
