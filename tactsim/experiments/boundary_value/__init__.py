"""A boundary value problem as it is posed on paper: a body, what is prescribed on its faces, and what is asked of it."""
