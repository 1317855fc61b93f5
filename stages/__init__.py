"""The science: each stage is one folder; they meet in artefacts.py and numerics/."""
