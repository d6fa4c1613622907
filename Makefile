# Everything starts from here: `make demo`, `make test`, `make check`, `make bench`. Needs Python 3.11+.

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
ifeq ($(OS),Windows_NT)
BIN := $(VENV)/Scripts
endif
DSE := $(BIN)/dse
WORKERS ?= 2
JOBS ?= 2
# A machine without a C compiler gets one as a wheel.
EXTRA := $(shell command -v $${CC:-cc} >/dev/null 2>&1 || command -v gcc >/dev/null 2>&1 || command -v clang >/dev/null 2>&1 || echo "[toolchain]")

.PHONY: demo test test-all check bench setup clean lint format-check types layers web

setup: $(VENV)/.ready

SOURCES := $(wildcard dse/cosim/kernel/*.c dse/cosim/kernel/*.h dse/fmu/runtime/*.h dse/report/web/src/* dse/report/web/src/*/*)

$(VENV)/.ready: pyproject.toml hatch_build.py dse/report/web/package-lock.json $(SOURCES)
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "dse needs Python 3.11 or newer; set PYTHON=python3.11"; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade "pip>=25.1"
	$(BIN)/python -m pip install --quiet --editable ".$(EXTRA)" --group dev
	@touch $@

demo: setup
	$(BIN)/python -m dse check
	$(BIN)/python -m dse enumerate acc_vehicle --limit 5
	$(BIN)/python -m dse run acc_following -o out/acc_following --workers $(WORKERS)
	$(BIN)/python -m dse explore acc_gains -o out/acc_gains --workers $(WORKERS)
	$(BIN)/python -m dse report out/acc_following
	$(BIN)/python -m dse report out/acc_gains
	$(BIN)/python -m dse figure out/acc_gains -o out/figures
	@echo "Open out/acc_gains/report.html"

test: setup
	$(BIN)/python -m pytest -q -n $(JOBS) -m "not thorough"

test-all: setup
	$(BIN)/python -m pytest -q -n $(JOBS)

check: setup lint types layers web test-all

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: setup
	$(BIN)/mypy

layers: setup
	$(BIN)/lint-imports

web: setup
	$(BIN)/python hatch_build.py

bench: setup
	$(BIN)/python benchmarks/bench_kernel.py
	$(BIN)/python benchmarks/bench_study.py
	$(BIN)/python benchmarks/bench_space.py
	$(BIN)/python benchmarks/bench_modelica.py

clean:
	rm -rf out dist build dse/report/web/dist dse/report/web/node_modules dse/cosim/_kernel.* $(VENV)
