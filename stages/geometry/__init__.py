"""Film geometry: mid-surface, layers, fibres, and the refined meshes of both sub-problems."""
