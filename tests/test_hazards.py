"""Every test that docs/hazards.md names exists, and every claim names one."""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
ROWS = [
    line.strip("| ").split(" | ")
    for line in (ROOT / "docs" / "hazards.md").read_text(encoding="utf-8").splitlines()
    if line.startswith("|") and "---" not in line
][1:]


def test_every_hazard_names_tests_that_exist() -> None:
    assert len(ROWS) > 15
    for row in ROWS:
        assert len(row) == 4, row
        named = re.findall(r"`(tests/[\w/.]+)::(\w+)`", row[3])
        assert named, row
        for file, name in named:
            tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
            functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
            assert name in functions, f"{file}::{name}"


def test_it_claims_no_certification() -> None:
    text = (ROOT / "docs" / "hazards.md").read_text(encoding="utf-8")
    assert "No hardware was attached" in text
    assert "no conformity" in text
