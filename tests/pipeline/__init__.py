"""Tests of the engine, on stages made up for the purpose."""
