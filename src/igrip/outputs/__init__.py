"""Where intentions go, found by name: each output in its own file, with its own dependencies."""
