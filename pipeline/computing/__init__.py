"""How one result comes about: found in the store, read and checked, or computed and published."""
