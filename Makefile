# Two commands matter: `make demo` and `make test`. Both install what they need into .venv.
PYTHON ?= python3
BIN := .venv/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet
READY := .venv/.ready

# the near/far reaches of Wispinski et al. (2021): docs/importing.md has their source
REACHES ?= ../shared/data/wispinski2021
# the folder that holds them and the hands at work, for training
SHARED ?= ../shared/data

.PHONY: help demo test test-slow test-busy coverage lint types contract unit hooks dist lines \
	docs gallery notebooks benchmark commands schemas system clean bench pictures report golden train estimators
help:  ## this list
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | expand -t 12

demo: $(READY)  ## watch igrip predict what a simulated person reaches for
	$(BIN)/igrip demo

test: lint types contract unit  ## lint, types, import contract and every test

test-slow: $(READY)  ## the long suites
	$(BIN)/python -m pytest -m slow

test-busy: $(READY)  ## every test, while two busy processes compete with it
	$(BIN)/python tests/busy.py $(BIN)/python -m pytest

coverage: $(READY)  ## every test, and which lines none of them runs
	$(BIN)/python -m pytest --cov --cov-report=term

lint: $(READY)  ## style and spelling
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/codespell src tests training benchmarks docs examples *.md

types: $(READY)  ## static types
	$(BIN)/mypy

contract: $(READY)  ## the core imports nothing from the edges
	$(BIN)/lint-imports

unit: $(READY)  ## every test that is not slow, in two processes; what fails there again, alone
	$(BIN)/python -m pytest --numprocesses 2 --dist loadfile || $(BIN)/python -m pytest --last-failed

hooks: $(READY)  ## check every commit with the tools of .venv
	$(BIN)/pre-commit install

dist: $(READY)  ## build the wheel and the source distribution into dist/, and check them
	rm -rf dist
	$(BIN)/python -m build --no-isolation
	$(BIN)/python -m twine check --strict dist/*

lines: $(READY)  ## files and lines per package
	$(BIN)/python -m benchmarks.tree

schemas: $(READY)  ## write the message schemas into docs/schemas
	$(BIN)/igrip schema observation > docs/schemas/observation.json
	$(BIN)/igrip schema intention > docs/schemas/intention.json

system:  ## install what the tests of browsers, of C and of MQTT need from Debian (as root)
	apt-get update -qq
	apt-get install -y -qq --no-install-recommends chromium gcc libc6-dev mosquitto

clean:  ## remove the environment
	rm -rf .venv

$(READY): pyproject.toml constraints.txt requirements-test.txt
	$(PYTHON) -c 'import sys; sys.exit("igrip needs Python 3.11 or newer, this is %s: make PYTHON=python3.11 ..." % sys.version.split()[0] if sys.version_info < (3, 11) else 0)'
	$(PYTHON) -m venv .venv
	$(PIP) install --constraint constraints.txt --requirement requirements-test.txt --editable '.[viewer,tables,report,tune,bench,training,outputs,ros2,mcap,hands,poses,meshes,docs,devices,benchmark,cluster,notebooks]'
	$(PIP) install --no-deps --constraint constraints.txt ability-hand nml-hand-exo
	# ROS 2 has no wheels for some machines and versions of Python: its tests are skipped there
	-$(PIP) install --constraint constraints.txt --editable '.[ros]'
	touch $@

bench: $(READY)  ## measure the speed beside other engines; the picture of docs/benchmarks.md
	$(BIN)/python -m benchmarks --memory-frames 200000 --plot docs/pictures/bench.png

notebooks: $(READY)  ## run the notebooks and keep what they show
	$(BIN)/python docs/make_notebooks.py

benchmark: $(READY)  ## the table of docs/benchmark.md (half an hour); REACHES=FOLDER
	test -d build/four-people || $(BIN)/igrip simulate build/four-people --participants 4 --trials 32 --no-reach 8 --seed 12
	$(BIN)/igrip benchmark near_far=$(REACHES) simulated=build/four-people --out build/judged
	cp build/judged/table.md docs/output/benchmark.txt

pictures: $(READY)  ## draw the pictures of the documentation (after make system)
	$(BIN)/python docs/make_pictures.py
	$(BIN)/python docs/make_study_pictures.py
	$(BIN)/python docs/make_pages.py

docs: $(READY)  ## build the documentation site into build/site; a warning is an error
	NO_MKDOCS_2_WARNING=1 PYTHONPATH=docs $(BIN)/mkdocs build --strict --quiet

gallery: $(READY)  ## run every example and write the gallery with its pictures
	$(BIN)/python docs/make_gallery.py

commands: $(READY)  ## write the page of all commands
	$(BIN)/python docs/make_commands.py

report: $(READY)  ## write the report of a small cohort in the documentation
	$(BIN)/python docs/make_report.py

golden: $(READY)  ## rewrite the golden vectors, from the oracle alone
	$(BIN)/python tests/golden/make_golden.py

train: $(READY)  ## train the estimators (SHARED=folder of wispinski2021 and hands_at_work; 10 min)
	$(BIN)/python -m training $(SHARED)
	$(BIN)/python -m training.palm

estimators: $(READY)  ## write the tables of all estimators on all sets (REACHES=folder; half an hour)
	$(BIN)/python docs/make_estimators.py $(REACHES)
