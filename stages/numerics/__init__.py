"""Splines, surfaces, quadrature, solvers: pure numerics, no input or output."""
