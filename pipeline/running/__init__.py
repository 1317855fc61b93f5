"""A stage while it runs: its frames, its checkpoints and requests to stop, in a store or in memory."""
