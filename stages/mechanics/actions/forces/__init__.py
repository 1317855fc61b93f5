"""Forces that loads exert on the control points, apart from their configuration."""
