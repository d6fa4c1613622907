# Everything starts from here: `make demo`, `make docs`, `make drive`, `make test`, `make check`, `make nightly`, `make bench`. Needs
# Python 3.11+. LOCKED=1 sets up the versions of requirements.lock, and nothing with another hash.

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
ifeq ($(OS),Windows_NT)
BIN := $(VENV)/Scripts
endif
DSE := $(BIN)/python -m dse
WORKERS ?= 2
JOBS ?= 2
# Byte code is written when a module is first imported, so only for what is used.
unexport PYTHONDONTWRITEBYTECODE
# uv takes a seventh of pip's processor time. If it is not on PATH, pip fetches it; where uv fails, pip installs.
# uv does not read pip's configuration: an index that is named there is passed on.
UV := $(or $(shell command -v uv 2>/dev/null),$(BIN)/uv)
INSTALL = UV_DEFAULT_INDEX="$${UV_DEFAULT_INDEX:-$$($(BIN)/python -m pip config get global.index-url 2>/dev/null)}" \
  $(UV) pip install --python $(BIN)/python $(1) || $(BIN)/python -m pip install --no-compile $(1)
# A machine without a C compiler gets one as a wheel.
COMPILER := $(shell command -v $${CC:-cc} >/dev/null 2>&1 || command -v gcc >/dev/null 2>&1 || command -v clang >/dev/null 2>&1 || echo ",toolchain")

.PHONY: demo docs drive test thorough rest check nightly bench faults setup clean lint types layers web plugin wheels lock sbom audit msl

SOURCES := $(wildcard dse/cosim/kernel/*.c dse/cosim/kernel/*.h dse/csolve/*.h dse/report/web/src/* dse/report/web/src/*/*)
MADE_OF := pyproject.toml hatch_build.py dse/report/web/package-lock.json $(SOURCES)

define ENVIRONMENT
@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "dse needs Python 3.11 or newer; set PYTHON=python3.11"; exit 1; }
@echo "setting up $(VENV); this takes a minute"
$(PYTHON) -m venv $(VENV)
$(if $(filter $(BIN)/uv,$(UV)),$(BIN)/python -m pip install --disable-pip-version-check --no-compile uv "pip>=25.1")
endef

# What runs: the demo and test drives need no more.
$(VENV)/.run: $(MADE_OF)
	$(ENVIRONMENT)
	$(call INSTALL,--editable ".[serve$(COMPILER)]")
	@touch $@

# With it, what tests and checks need.
setup: $(VENV)/.ready

$(VENV)/.ready: $(MADE_OF)
	$(ENVIRONMENT)
	$(if $(LOCKED),$(call INSTALL,--require-hashes --requirement requirements.lock))
	$(call INSTALL,--editable ".[serve$(COMPILER)]" --group dev)
	@touch $(VENV)/.run $@

demo: $(VENV)/.run
	$(DSE) enumerate acc_vehicle --limit 5
	$(DSE) run acc_following -o out/acc_following --workers $(WORKERS)
	$(DSE) explore acc_gains -o out/acc_gains --workers $(WORKERS)
	$(DSE) report out/acc_following
	$(DSE) report out/acc_gains
	@echo "Open out/acc_gains/report.html"

# A test drive in the browser, on a bench to begin with: BENCH=drive_motorway is another.
BENCH ?= drive_following
drive: $(VENV)/.run
	$(DSE) drive $(BENCH)

# Workers take whole stretches of the list, so that what tests share is made once; who is done early takes of the rest.
PYTEST := $(BIN)/python -m pytest -q -n $(JOBS) --dist worksteal -p no:anyio

# Only the tests that a change can reach: ROOMS=changed, or rooms of dse: ROOMS=cosim,fmu. ROOMS=base: the tests of what
# changed since the last whole run, which .ci/base names, and a fifth of the others.
ROOMS ?=
test: setup
	$(PYTEST) -m "not thorough and not nightly" $(if $(ROOMS),--rooms $(ROOMS),--budget)

# As users compile, with the optimizer. PART=1/2 runs these folders, PART=2/2 the others.
FIRST_PART := tests/api tests/cli tests/docs tests/exploration tests/report
thorough: setup web
	$(PYTEST) --optimized -m "thorough and not nightly" --hypothesis-profile=thorough \
	  $(if $(ROOMS),--rooms $(ROOMS)) $(if $(filter 1/2,$(PART)),$(FIRST_PART)) $(if $(filter 2/2,$(PART)),$(FIRST_PART:%=--ignore=%))

# Everything: the everyday tests, then what they leave out. Runs of CI may then start from here.
check: test rest
	$(if $(ROOMS)$(PART),,! git diff --quiet HEAD || git rev-parse HEAD >.ci/base)

rest: lint types layers web plugin docs thorough

# The documentation site: build/site/index.html, with notebooks that are run. Needs no network.
docs: setup
	$(BIN)/python docs/site/make.py

# What others add: the example is installed beside, so that it stands in no report of ours, and passes every suite.
plugin: setup
	rm -rf $(VENV)/plugin
	$(call INSTALL,--no-deps --no-build-isolation --target $(VENV)/plugin examples/plugin)
	PYTHONPATH=$(VENV)/plugin $(PYTEST) examples/plugin/tests

# Other examples than yesterday, ten times as many, and all commands in all environments.
nightly: setup
	$(PYTEST) -m "nightly or hypothesis" --hypothesis-profile=nightly

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/python .ci/house.py
	$(BIN)/check-jsonschema --builtin-schema vendor.github-workflows .github/workflows/ci.yml
	$(BIN)/check-jsonschema --builtin-schema vendor.github-actions action.yml
	$(BIN)/check-jsonschema --builtin-schema vendor.github-issue-forms .github/ISSUE_TEMPLATE/bug.yml .github/ISSUE_TEMPLATE/idea.yml
	$(BIN)/check-jsonschema --builtin-schema vendor.citation-file-format CITATION.cff

types: setup
	$(BIN)/mypy

layers: setup
	$(BIN)/lint-imports

web: setup
	$(BIN)/python hatch_build.py

# For each platform in hatch_build.py a wheel, with the report that `dse demo` opens, and the sources; docs/releases.md.
wheels: setup web
	$(DSE) explore acc_gains -o build/demo --workers $(WORKERS)
	$(DSE) report build/demo
	$(BIN)/python -m hatchling build -t sdist
	$(BIN)/python -c 'import hatch_build; print(*hatch_build.PLATFORMS)' | xargs -n 1 | while read platform; do \
	  DSE_DEMO=build/demo/report.html DSE_PLATFORM=$$platform $(BIN)/python -m hatchling build -t wheel || exit 1; done

bench: setup
	$(BIN)/python benchmarks/bench_kernel.py
	$(BIN)/python benchmarks/bench_fused.py
	$(BIN)/python benchmarks/bench_study.py
	$(BIN)/python benchmarks/bench_space.py
	$(BIN)/python benchmarks/bench_evolution.py
	$(BIN)/python benchmarks/bench_optimise.py --only nsga2
	$(BIN)/python benchmarks/bench_modelica.py
	$(BIN)/python benchmarks/bench_startup.py
	$(BIN)/python benchmarks/bench_scaling.py
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

# The Modelica Standard Library against its published reference results: folders of a release of each, which are not
# part of dse. Not part of CI. ONLY=expression of models' names, EVERY=n for each n-th model.
MODELICA ?=
REFERENCES ?=
msl: $(VENV)/.ready
	@test -n "$(MODELICA)" -a -n "$(REFERENCES)" || { echo "name the folders: make msl MODELICA=folder REFERENCES=folder"; exit 1; }
	$(BIN)/python benchmarks/msl.py "$(MODELICA)" "$(REFERENCES)" --only "$(ONLY)" --every $(or $(EVERY),1)
