# Everything happens in .venv; `make run` and `make test` are all a newcomer needs.
PYTHON ?= python3
VENV := .venv
PIP := $(VENV)/bin/python -m pip --disable-pip-version-check

.PHONY: run test test-slow test-paper lint format bench clean
.DEFAULT_GOAL := run

$(VENV)/installed: pyproject.toml constraints.txt
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "myofilm needs Python 3.11 or newer: make PYTHON=python3.11")'
	$(PYTHON) -m venv $(VENV)
	$(PIP) install --quiet --constraint constraints.txt --editable .
	@touch $@

$(VENV)/installed-dev: $(VENV)/installed
	$(PIP) install --quiet --constraint constraints.txt --editable '.[dev]'
	@touch $@

run: $(VENV)/installed                ## the main job: an electrical wave makes a film beat
	$(VENV)/bin/myofilm run planar-waves

test: $(VENV)/installed-dev           ## the test suite
	$(VENV)/bin/python -m pytest -n auto

test-slow: $(VENV)/installed-dev      ## convergence and verification studies (minutes)
	$(VENV)/bin/python -m pytest -m slow

test-paper: $(VENV)/installed-dev     ## the paper's full resolution
	$(VENV)/bin/python -m pytest -m paper

lint: $(VENV)/installed-dev           ## style, types, architecture
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/mypy
	$(VENV)/bin/lint-imports

format: $(VENV)/installed-dev
	$(VENV)/bin/ruff check --fix .
	$(VENV)/bin/ruff format .

bench: $(VENV)/installed-dev          ## where the time of the main job goes
	$(VENV)/bin/python benchmarks/main_job.py

clean:
	rm -rf $(VENV) build dist *.egg-info
