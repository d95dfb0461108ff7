"""The command ``igrip``; one file per subcommand."""

from __future__ import annotations

import sys


def main() -> None:
    """Run the command. Exit codes: 0 done, 1 done but something failed, 2 wrong input."""
    try:  # Ctrl-C is no error while the commands are still being imported, either
        from igrip.cli.app import app
        from igrip.cli.log_lines import keep_apart

        keep_apart()
        app()
    except KeyboardInterrupt:
        print("igrip: stopped; nothing was written", file=sys.stderr)
        sys.exit(130)
