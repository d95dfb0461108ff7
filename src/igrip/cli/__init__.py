"""The command ``igrip``."""


def main() -> None:
    """Run the command."""
