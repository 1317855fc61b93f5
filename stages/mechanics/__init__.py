"""Kirchhoff-Love shell with active stress."""
