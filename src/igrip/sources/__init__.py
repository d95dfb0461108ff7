"""Where observations come from, found by the form of a name such as ``reach.jsonl``."""
