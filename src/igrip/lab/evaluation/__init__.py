"""The paper's evaluation of any dataset."""
