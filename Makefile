# `make packing` plans the easy packing problems, `make test` runs the tests; both set up .venv first.
PYTHON ?= python3
VENV ?= .venv
WORKERS ?= 2
LEVEL ?= easy
ARGS ?=

BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip
# pydrake is linked against the system's GLib, the one library that its wheel does not bring.
HAS_GLIB = $(BIN)/python -c 'import ctypes; ctypes.CDLL("libglib-2.0.so.0")' 2>/dev/null
HAS_CHROMIUM = command -v chromium || command -v chromium-browser || command -v google-chrome

.PHONY: help install install-test packing test robustness check lint prose types dependencies contracts format wheel constraints clean

help:  ## say what there is
	@sed -n 's/^\([a-z-]*\):.*## /\1: /p' Makefile

packing: install  ## plan, execute and record the packing problems of LEVEL (easy, medium, hard)
	$(BIN)/python -m ictamp_drake.experiments.packing --level $(LEVEL) $(ARGS)

test: install-test  ## run the tests, all but those of the built wheel
	@$(HAS_CHROMIUM) >/dev/null || scripts/apt_install.sh chromium "No Chromium for the tests of the replay page." || true
	$(BIN)/python -m pytest -n $(WORKERS) -m "not wheel" $(ARGS)

robustness: install  ## execute plans with moved boxes and changed physics, and write benchmarks/robustness.md
	$(BIN)/python benchmarks/robustness.py $(ARGS)

check: lint prose types dependencies contracts  ## lint, prose, types, dependencies and contracts, one after the other

lint: install-test  ## style and format of the code
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

prose: install-test  ## spelling, and docstrings that stand alone
	$(BIN)/codespell
	$(BIN)/python scripts/check_prose.py

types: install-test  ## the type checker
	$(BIN)/mypy

dependencies: install-test  ## packages that are used and not declared, or declared and not used
	$(BIN)/deptry .

contracts: install-test  ## which room may import which
	$(BIN)/lint-imports --no-logo

wheel: install-test  ## build the wheel and test what is in it
	$(BIN)/python -m pytest -m wheel $(ARGS)

format: install-test  ## let ruff mend what it can
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

install: $(VENV)/installed
install-test: $(VENV)/installed-test

define set_up
	@$(PYTHON) scripts/check_python.py
	$(PYTHON) -m venv $(VENV)
	$(PIP) install --quiet --upgrade -c constraints.txt pip setuptools
	$(PIP) install --no-build-isolation -c constraints.txt -e '$(1)'
	@$(HAS_GLIB) || scripts/apt_install.sh libglib2.0-0 "Drake needs GLib, which is missing."
	@touch $@
endef

# The stamps make a second run quick.
$(VENV)/installed: pyproject.toml constraints.txt
	$(call set_up,.)

$(VENV)/installed-test: pyproject.toml constraints.txt
	$(call set_up,.[test])
	@touch $(VENV)/installed

# The versions that are chosen by hand stay; everything else becomes the newest that fits them.
constraints: FRESH := $(shell mktemp -d)
constraints:  ## write constraints.txt anew
	grep -E '^(drake|ompl|torch)==' constraints.txt > $(FRESH)/held.txt
	$(PYTHON) -m venv $(FRESH)/venv
	$(FRESH)/venv/bin/pip install --quiet --upgrade pip setuptools
	$(FRESH)/venv/bin/pip install -c $(FRESH)/held.txt '.[test]'
	$(FRESH)/venv/bin/pip freeze --all --exclude ictamp_drake | sed 's/+[a-z0-9.]*$$//' > constraints.txt
	rm -r $(FRESH)

clean:  ## remove the environment and what was built
	rm -rf $(VENV) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache
