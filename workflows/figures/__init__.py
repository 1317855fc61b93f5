"""Pictures of an experiment in the layout of the paper's figures."""
