"""The comparison of two source trees."""

import json

from typer.testing import CliRunner

from benchmarks import startup


def test_two_trees_are_compared(tmp_path):
    for name in ("old", "new"):
        (tmp_path / name / "igrip").mkdir(parents=True)
        (tmp_path / name / "igrip" / "__init__.py").write_text("")
        (tmp_path / name / "igrip" / "__main__.py").write_text("")
    app = startup.typer.Typer()
    app.command()(startup.main)
    arguments = [str(tmp_path / "old"), str(tmp_path / "new"), "--repeats", "1", "--json"]
    report = json.loads(CliRunner().invoke(app, arguments).stdout)
    assert set(report) == {"import igrip", "igrip --help"}
    for row in report.values():
        assert row["ratio"] == row["new_s"] / row["old_s"]
