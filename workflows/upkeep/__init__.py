"""Looking after the store: lists, what may go, what is damaged. Plain JSON is all that is read."""
