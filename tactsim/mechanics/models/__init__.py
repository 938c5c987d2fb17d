"""Finite element models: of a section, of tissue in space, of a block between jaws, of a body under prescribed loads."""
