"""Transfer of the active stress from the electrophysiology mesh to the shell."""
