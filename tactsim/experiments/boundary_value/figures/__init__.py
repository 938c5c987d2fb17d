"""The figures of boundary value problems."""
