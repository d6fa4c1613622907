# Everything starts from here: `make demo`, `make drive`, `make test`, `make check`, `make nightly`, `make bench`. Needs
# Python 3.11+; with uv on PATH, set-up is quicker. LOCKED=1 sets up the versions of requirements.lock, and nothing with
# another hash.

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
ifeq ($(OS),Windows_NT)
BIN := $(VENV)/Scripts
endif
DSE := $(BIN)/dse
WORKERS ?= 2
JOBS ?= 2
UV := $(shell command -v uv 2>/dev/null)
PIP := $(if $(UV),$(UV) pip install --quiet --python $(VENV),$(BIN)/python -m pip install --quiet)
# A machine without a C compiler gets one as a wheel.
EXTRA := $(shell command -v $${CC:-cc} >/dev/null 2>&1 || command -v gcc >/dev/null 2>&1 || command -v clang >/dev/null 2>&1 || echo "[toolchain]")

.PHONY: demo drive test thorough rest check nightly bench faults setup clean lint types layers web plugin lock sbom audit

setup: $(VENV)/.ready

SOURCES := $(wildcard dse/cosim/kernel/*.c dse/cosim/kernel/*.h dse/csolve/*.h dse/report/web/src/* dse/report/web/src/*/*)

$(VENV)/.ready: pyproject.toml hatch_build.py dse/report/web/package-lock.json $(SOURCES)
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "dse needs Python 3.11 or newer; set PYTHON=python3.11"; exit 1; }
ifneq ($(UV),)
	$(UV) venv --quiet --seed --allow-existing --python "$(PYTHON)" $(VENV)
	$(if $(LOCKED),$(PIP) --compile-bytecode --require-hashes --requirement requirements.lock)
	$(PIP) --compile-bytecode --editable ".$(EXTRA)" --group dev
else
	$(PYTHON) -m venv $(VENV)
	$(PIP) --upgrade "pip>=25.1"
	$(if $(LOCKED),$(PIP) --require-hashes --requirement requirements.lock)
	$(PIP) --editable ".$(EXTRA)" --group dev
endif
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

# A test drive in the browser, on a bench to begin with: BENCH=drive_motorway is another.
BENCH ?= drive_following
drive: setup
	$(BIN)/python -m dse drive $(BENCH)

# Workers take whole stretches of the list, so that what tests share is made once; who is done early takes of the rest.
PYTEST := $(BIN)/python -m pytest -q -n $(JOBS) --dist worksteal

# Only the tests that a change can reach: ROOMS=changed, or rooms of dse: ROOMS=cosim,fmu.
ROOMS ?=
test: setup
	$(PYTEST) -m "not thorough and not nightly" $(if $(ROOMS),--rooms $(ROOMS))

# Tests of properties are run once more, on twice as many examples. PART=1/2 runs these folders, PART=2/2 the others.
FIRST_PART := tests/api tests/cli tests/docs tests/exploration tests/report
thorough: setup
	$(PYTEST) -m "(thorough or hypothesis) and not nightly" --hypothesis-profile=thorough \
	  $(if $(filter 1/2,$(PART)),$(FIRST_PART)) $(if $(filter 2/2,$(PART)),$(FIRST_PART:%=--ignore=%))

# All of CI: the everyday tests, then what they leave out.
check: test rest

rest: lint types layers web plugin thorough

# What others add: the example is installed beside, so that it stands in no report of ours, and passes every suite.
plugin: setup
	rm -rf $(VENV)/plugin
	$(PIP) --no-deps --no-build-isolation --target $(VENV)/plugin examples/plugin
	PYTHONPATH=$(VENV)/plugin $(PYTEST) examples/plugin/tests

# Other examples than yesterday, ten times as many, and all commands in all environments.
nightly: setup
	$(PYTEST) -m "nightly or hypothesis" --hypothesis-profile=nightly

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/check-jsonschema --builtin-schema vendor.github-workflows .github/workflows/ci.yml
	$(BIN)/check-jsonschema --builtin-schema vendor.github-issue-forms .github/ISSUE_TEMPLATE/bug.yml .github/ISSUE_TEMPLATE/idea.yml
	$(BIN)/check-jsonschema --builtin-schema vendor.citation-file-format CITATION.cff

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
	$(BIN)/python benchmarks/bench_evolution.py
	$(BIN)/python benchmarks/bench_optimise.py --only nsga2
	$(BIN)/python benchmarks/bench_modelica.py
	$(BIN)/python benchmarks/bench_startup.py
	$(BIN)/python benchmarks/bench_world.py

# Every call of the system that a small study makes fails once, and 200 signals; hours. What is in out/faults.jsonl is done.
faults: setup
	PYTHONPATH=tests $(BIN)/python -m faults.everything --write
	PYTHONPATH=tests $(BIN)/python -m faults.storm --write

# What dse is made of. The tools for that have an environment of their own, so that they are in no list.
SUPPLY := $(VENV)/supply/$(notdir $(BIN))

$(VENV)/supply/.ready: pyproject.toml
	$(PYTHON) -m venv $(VENV)/supply
	$(SUPPLY)/python -m pip install --quiet --upgrade "pip>=25.1"
	$(SUPPLY)/python -m pip install --quiet --group supply
	@touch $@

COMPILE = $(SUPPLY)/uv pip compile --quiet --no-header --no-annotate --no-emit-index-url pyproject.toml

# Keeps the versions that are locked already; `make lock NEWEST=1` takes the newest.
lock: $(VENV)/supply/.ready
	$(COMPILE) --group dev --universal --generate-hashes $(if $(NEWEST),--upgrade) --output-file requirements.lock

# dist/sbom.json (CycloneDX) has what an installation holds, docs/licences.md under which licences.
sbom: setup $(VENV)/supply/.ready
	mkdir -p dist
	$(COMPILE) --generate-hashes --constraint requirements.lock --output-file dist/requirements.txt
	$(SUPPLY)/cyclonedx-py requirements --pyproject pyproject.toml --output-reproducible --output-file dist/sbom.json dist/requirements.txt
	@sed '/^|/,$$d' docs/licences.md >dist/licences.md
	$(SUPPLY)/pip-licenses --python $(BIN)/python --format markdown --no-version --with-urls --from mixed \
	  --packages $$(sed -n 's/==.*//p' dist/requirements.txt) >>dist/licences.md
	mv dist/licences.md docs/licences.md

audit: $(VENV)/supply/.ready
	$(SUPPLY)/python .ci/audit.py

clean:
	rm -rf out dist build dse/report/web/dist dse/report/web/node_modules dse/cosim/_kernel.* $(VENV)
