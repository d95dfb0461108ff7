"""The command ``igrip``; one file per subcommand."""

from __future__ import annotations

import logging
import sys

from igrip.cli.app import app
from igrip.errors import IgripError


def main() -> None:
    """Run the command. Exit codes: 0 done, 1 done but something failed, 2 wrong input."""
    logging.getLogger("igrip").addHandler(logging.NullHandler())  # the commands print their own
    try:
        app()
    except IgripError as error:
        from igrip.cli.console import errors

        errors.print(f"igrip: {error}", style="red", soft_wrap=True)
        sys.exit(2)
    except BrokenPipeError:  # the reader of our output closed it, which is no error
        sys.stderr.close()
        sys.exit(0)
    except KeyboardInterrupt:
        sys.exit(130)
