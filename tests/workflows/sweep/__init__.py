"""Sweeps over parameters."""
