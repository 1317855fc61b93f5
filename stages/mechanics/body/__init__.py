"""The film with all that holds and loads it: what statics, dynamics and buckling solve for."""
