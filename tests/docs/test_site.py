"""The documentation site builds without a warning, and its pages hold what they promise."""

import html
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the site; return its folder."""
    pytest.importorskip("mkdocs")
    folder = tmp_path_factory.mktemp("site")
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", folder],
        cwd=ROOT, env={**os.environ, "PYTHONPATH": "docs", "NO_MKDOCS_2_WARNING": "1"},
        capture_output=True, text=True, timeout=280,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return folder


def test_no_page_is_empty_and_no_included_file_is_missing(site: Path) -> None:
    for page in (ROOT / "docs").glob("[!_]*.md"):
        name = "index.html" if page.stem == "index" else f"{page.stem}/index.html"
        text = (site / name).read_text(encoding="utf-8")
        assert "<h1" in text, page
        shown = html.unescape(re.sub(r"<[^>]+>", "", text.partition("<article")[2]))
        assert not re.search(r"--8\s*<", shown), page


def test_the_pages_hold_examples_formulas_schemas_and_docstrings(site: Path) -> None:
    def text(page: str) -> str:
        return (site / page / "index.html").read_text(encoding="utf-8")

    assert "minimum-jerk" in text("start")
    assert "<math" in text("mathematics")
    assert "valid_until" in text("messages")
    assert "read_intentions" in text("api")
    assert (site / "clients" / "lease.py").is_file()


def test_nothing_is_loaded_from_other_servers(site: Path) -> None:
    for page in ("index.html", "gallery/index.html"):
        text = (site / page).read_text(encoding="utf-8")
        assert 'src="http' not in text
        assert 'rel="stylesheet" href="http' not in text
