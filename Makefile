# Everything here works on a fresh clone with git, make and Python 3.11 or newer.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
export PYTHONPATH := .:models

.PHONY: help demo test fit check bench docs format clean
help:
	@echo "make demo    the measured samples: printed against computed, before and after"
	@echo "make test    the test suite"
	@echo "make fit     every screen in four languages and three windows: nothing is cut"
	@echo "make check   format, lint, types, layers, generated docs"
	@echo "make bench   speed as ratios against a peer, and the full Monte Carlo campaigns"
	@echo "make docs    write the generated reference pages anew"

$(STAMP): pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	touch $(STAMP)

demo: $(STAMP)
	$(BIN)/python -m surveyapp demo

test: $(STAMP)
	$(BIN)/python -m pytest -n 2 --dist loadfile

fit: $(STAMP)
	SURVEYAPP_FIT_EVERY_SIZE=1 $(BIN)/python -m pytest -n 2 tests/languages/test_screens_fit.py

check: $(STAMP)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python scripts/generate_docs.py --check

bench: $(STAMP)
	$(BIN)/python -m bench

docs: $(STAMP)
	$(BIN)/python scripts/generate_docs.py

format: $(STAMP)
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

clean:
	rm -rf $(VENV) build dist .mypy_cache .ruff_cache .hypothesis .import_linter_cache
