"""What every hand detector shares: palms, ids, tiles of a picture."""
