"""Studies at the resolution of the paper; run by `make test-slow` and `make test-paper`."""
