"""What supports and loads are made of: edges, points, relations of control points, nodal forces."""
