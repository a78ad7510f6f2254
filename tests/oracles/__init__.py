"""Independent references: solvers that share no code with the product."""
