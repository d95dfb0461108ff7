"""Virtual twins, one for each device: the other end of its wire, without hardware."""
