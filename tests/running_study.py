"""A study in a process of its own, with its screens in the browser."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import urllib.request

from runtime_fakes import PATIENCE

COMMAND = """
import functools, os, signal, sys
import igrip.cli.experiment as command
from igrip.cli import main
name, sys.argv[1:] = sys.argv[1], sys.argv[2:]
def passed(transition):
    if transition == name:
        os.kill(os.getpid(), signal.SIGKILL)
command.Session = functools.partial(command.Session, passed=passed)
main()
"""


class Running:
    """``igrip experiment run`` in its own process.

    Parameters
    ----------
    folder : StudyFolder
        Of the study.
    options : str
        More of the command.
    killed_at : str
        The transition at which it ends itself, as by a power cut; empty: none.
    """

    def __init__(self, folder, *options, killed_at=""):
        self.process = subprocess.Popen(
            [sys.executable, "-c", COMMAND, killed_at, "experiment", "run", str(folder.path),
             "--participant", "P01", "--consent", "2026-01-31", "--simulate", "--port", "0",
             *options],
            stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
        for line in self.process.stderr:
            if found := re.match(r"participant: +(http://\S+)/participant", line):
                self.url = found[1]
                break
        else:
            raise AssertionError(self.process.wait())

    def status(self):
        with urllib.request.urlopen(f"{self.url}/status", timeout=PATIENCE) as answer:
            return json.load(answer)

    def order(self, name):
        request = urllib.request.Request(f"{self.url}/{name}", data=b"{}")
        urllib.request.urlopen(request, timeout=PATIENCE).close()

    def end(self, number):
        self.process.send_signal(number)
        code = self.process.wait(PATIENCE)
        self.process.stderr.close()
        self.process.stdout.close()
        return code
