"""Motion of a hand: filters, the recent trajectory, its near future, the phase of a reach."""
