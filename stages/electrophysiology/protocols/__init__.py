"""Experiments on excitable tissue alone: many cases that branch off one paced run."""
