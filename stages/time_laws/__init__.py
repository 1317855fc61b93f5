"""Laws q(t) of loads and imposed activation over time, one per file, picked by name."""
