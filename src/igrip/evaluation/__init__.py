"""How well an estimator does on recordings: pure functions from arrays to arrays."""
