"""Kinds of stimuli, one per file, picked by ``kind``."""
