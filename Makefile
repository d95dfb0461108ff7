# Two commands matter: `make demo` and `make test`. Both install what they need into .venv.
PYTHON ?= python3
BIN := .venv/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet
READY := .venv/.ready

REACHES ?= ../shared/data/wispinski2021

.PHONY: train estimators pictures report golden help demo test test-slow lint types contract unit schemas system clean
help:  ## this list
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | expand -t 12

demo: $(READY)  ## watch igrip decide what a simulated person reaches for
	$(BIN)/igrip demo

test: lint types contract unit  ## lint, types, import contract and every test

test-slow: $(READY)  ## the long suites
	$(BIN)/python -m pytest -m slow

lint: $(READY)  ## style and spelling
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/codespell src tests training docs examples *.md

types: $(READY)  ## static types
	$(BIN)/mypy

contract: $(READY)  ## the core imports nothing from the edges
	$(BIN)/lint-imports

unit: $(READY)  ## every test that is not slow
	$(BIN)/python -m pytest

schemas: $(READY)  ## write the message schemas into docs/schemas
	$(BIN)/igrip schema observation > docs/schemas/observation.json
	$(BIN)/igrip schema intention > docs/schemas/intention.json

system:  ## what the tests of browsers and of C want from Debian (as root)
	apt-get update -qq
	apt-get install -y -qq --no-install-recommends chromium gcc libc6-dev

clean:  ## forget the environment
	rm -rf .venv

$(READY): pyproject.toml constraints.txt requirements-test.txt
	$(PYTHON) -c 'import sys; sys.exit("igrip needs Python 3.11 or newer, this is %s: make PYTHON=python3.11 ..." % sys.version.split()[0] if sys.version_info < (3, 11) else 0)'
	$(PYTHON) -m venv .venv
	$(PIP) install --constraint constraints.txt --requirement requirements-test.txt --editable '.[viewer,tables,report,bench,training,outputs,mcap,hands,poses]'
	touch $@

pictures: $(READY)  ## make the pictures of the documentation (after make system)
	$(BIN)/python docs/make_pictures.py

report: $(READY)  ## make the report of a small cohort in the documentation
	$(BIN)/python docs/make_report.py

golden: $(READY)  ## write the golden vectors anew, from the oracle alone
	$(BIN)/python tests/golden/make_golden.py

train: $(READY)  ## train what is learned (REACHES=folder with the tables of near/far reaches; 6 min)
	$(BIN)/python -m training $(REACHES)

estimators: $(READY)  ## make the tables of all estimators on all sets (REACHES=folder; half an hour)
	$(BIN)/python docs/make_estimators.py $(REACHES)
