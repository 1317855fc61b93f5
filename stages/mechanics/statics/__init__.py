"""Shapes in equilibrium: load paths, arc length, buckling."""
