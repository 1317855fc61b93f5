"""Studies that compare the solvers with closed forms and published values."""
