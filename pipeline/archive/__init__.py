"""Results of a store in one file, to be passed on: writing such a file, and taking one in."""
