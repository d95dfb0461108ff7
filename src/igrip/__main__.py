"""``python -m igrip``: the command."""

from igrip.cli import main

main()
