"""Files made from the results of a run, and the ledger that tells which are up to date."""
