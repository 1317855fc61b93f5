"""Measures of the beating film: probes, curvature, activation times, conduction velocity."""
