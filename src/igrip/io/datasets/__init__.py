"""Datasets: a folder of recordings with a table of trials."""
