"""The command ``igrip``; one file a subcommand."""

from __future__ import annotations

import logging
import sys

from igrip.cli.app import app
from igrip.cli.console import errors
from igrip.errors import IgripError


def main() -> None:
    """Run the command. Exit codes: 0 done, 1 done but something failed, 2 wrong input."""
    logging.getLogger("igrip").addHandler(logging.NullHandler())  # the commands say it themselves
    try:
        app()
    except IgripError as error:
        errors.print(f"igrip: {error}", style="red", soft_wrap=True)
        sys.exit(2)
    except BrokenPipeError:  # the reader of our output left; that is its right
        sys.stderr.close()
        sys.exit(0)
    except KeyboardInterrupt:
        sys.exit(130)
