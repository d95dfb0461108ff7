"""The command ``igrip``; one file per subcommand."""

from __future__ import annotations

import logging
import sys

from igrip.cli.app import app
from igrip.errors import IgripError


class WarningPrinter(logging.Handler):
    """Print warnings of the library as those of the commands, each once."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._printed: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        """Print one warning."""
        from igrip.cli.console import warn

        text = record.getMessage()
        if text not in self._printed:
            self._printed.add(text)
            warn(text)


def main() -> None:
    """Run the command. Exit codes: 0 done, 1 done but something failed, 2 wrong input."""
    logging.getLogger("igrip").addHandler(logging.NullHandler())  # the commands print their own
    logging.getLogger("igrip.objects").addHandler(WarningPrinter())
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
