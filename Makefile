# `make demo`, `make test`, `make check`: each alone is enough on a machine with Python >= 3.11, make and the network.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

# One BLAS thread: the thread count changes the last bits of results.
export OPENBLAS_NUM_THREADS := 1
export OMP_NUM_THREADS := 1

.PHONY: help install viewers demo test coverage check gallery format lock clean

help:
	@echo "make demo   the whole way, small: fly, identify, plan, fly the plan, review"
	@echo "make test   the tests"
	@echo "make coverage   the tests, with the lines and branches they run"
	@echo "make check  format, lint, types, layers"
	@echo "make gallery ULOG=FILE   the pictures of docs/review.md anew; that of an imported log where one is named"

install: $(VENV)/installed

# The search for plans is C: a compiler comes along where the machine has none.
$(VENV)/installed: requirements.txt requirements-compiler.txt pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(None if sys.version_info >= (3, 11) else "Python >= 3.11 is needed, this is " + sys.version)'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.txt
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	@command -v cc >/dev/null || command -v gcc >/dev/null || command -v clang >/dev/null || \
		$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements-compiler.txt
	touch $@

# Rerun's converter, half a gigabyte; without it the tests that ask it are skipped.
viewers: install
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements-viewers.txt

demo: install
	$(BIN)/maneuver demo --out demo --force

test: install
	$(BIN)/python -m pytest -n auto --dist loadfile

# Tracing about doubles the time of the tests; CI traces those named in COVERED.
COVERED ?= tests
coverage: install
	$(BIN)/python -m pytest -n auto --dist loadfile --cov --cov-report term $(COVERED)

check: install
	$(BIN)/ruff format --check
	$(BIN)/ruff check
	$(BIN)/mypy
	$(BIN)/lint-imports

gallery: install
	$(BIN)/python -m tools.gallery $(ULOG)

format: install
	$(BIN)/ruff format
	$(BIN)/ruff check --fix

# Needs pip-tools; writes names, versions and hashes, and no address.
lock:
	$(PYTHON) -m piptools compile --quiet --strip-extras --allow-unsafe --extra dev --generate-hashes \
		--no-emit-index-url --no-emit-trusted-host --no-emit-find-links --no-header --output-file requirements.txt pyproject.toml
	$(PYTHON) -m piptools compile --quiet --strip-extras --allow-unsafe --extra dev --extra viewers --generate-hashes \
		--no-emit-index-url --no-emit-trusted-host --no-emit-find-links --no-header --constraint requirements.txt \
		--output-file requirements-viewers.txt pyproject.toml
	$(PYTHON) -c 'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["project"]["optional-dependencies"]["compiler"])' | \
		$(PYTHON) -m piptools compile --quiet --strip-extras --allow-unsafe --generate-hashes \
		--no-emit-index-url --no-emit-trusted-host --no-emit-find-links --no-header --output-file requirements-compiler.txt -

clean:
	rm -rf $(VENV) demo
