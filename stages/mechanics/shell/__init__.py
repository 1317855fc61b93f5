"""The discrete shell: from control points to forces, stiffness, mass, stresses."""
