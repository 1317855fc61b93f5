"""Where results come from, told in words, as a tree and as a picture."""
