"""Which results are computed when: node by node, and once for all cases of a study that need them."""
