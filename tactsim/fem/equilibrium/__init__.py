"""Newton's method: one equilibrium under given loads, what counts as balance, and where it fails."""
