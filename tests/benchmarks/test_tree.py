"""The table of lines, and the longest file."""

from pathlib import Path

from benchmarks import tree

ROOT = Path(__file__).parents[2]


def test_no_file_is_longer_than_300_lines():
    paths = [*(ROOT / "src").rglob("*.py")]
    paths += [path for name in ("benchmarks", "training") for path in (ROOT / name).rglob("*.py")]
    lengths = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in paths}
    assert len(lengths) > 100
    assert {path: n for path, n in lengths.items() if n > tree.MAX_LINES} == {}


def test_files_are_counted_by_package_and_split_by_the_import_contract(tmp_path):
    package = tmp_path / "src" / "igrip"
    (package / "cues").mkdir(parents=True)
    (package / "cli").mkdir()
    (package / "cues" / "__init__.py").write_text("a = 1\nb = 2\n")
    (package / "cues" / "one.py").write_text("\n" * 4)
    (package / "cli" / "app.py").write_text("\n" * 10)
    (package / "estimator.py").write_text("\n" * 7)
    (tmp_path / "pyproject.toml").write_text(
        '[[tool.importlinter.contracts]]\ntype = "forbidden"\n'
        'source_modules = ["igrip.cues", "igrip.estimator"]\n'
    )
    assert tree.core(tmp_path) == {"cues", "estimator"}
    columns = [list(column.cells) for column in tree.table(tmp_path).columns]
    rows = list(zip(*columns, strict=True))
    assert rows == [
        ("core", "cues", "2", "6", "3", "4"),
        ("core", "estimator", "1", "7", "7", "7"),
        ("edge", "cli", "1", "10", "10", "10"),
        ("core", "", "3", "13", "4", "7"),
        ("edge", "", "1", "10", "10", "10"),
        ("all", "", "4", "23", "6", "10"),
    ]


def test_the_core_of_this_checkout():
    assert {"estimator", "geometry", "commitment"} <= tree.core(ROOT)
    assert not {"cli", "viewer", "lab", "runtime", "io"} & tree.core(ROOT)
