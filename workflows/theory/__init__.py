"""Closed forms that results are compared with; written apart from the solver, on NumPy and SciPy alone."""
