"""Electrophysiology by isogeometric collocation, with the active stress of the cells."""
