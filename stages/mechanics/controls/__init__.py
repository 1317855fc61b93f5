"""What a quasi-static run proceeds by: one kind a file, chosen by `mechanics.control`."""
