# Everything stands on `make install`: a virtual environment in .venv with pinned, hashed packages.
PYTHON ?= python3
# By the cores and the memory: 4 GB are enough.
TEST_PROCESSES ?= $(shell $(PYTHON) tests/load.py processes)
TEST_JOBS ?= $(shell $(PYTHON) tests/load.py jobs)
# How often each fault is injected, and the file to write the table of results to, if any.
TRIALS ?= 1
FAULT_TABLE ?=
VENV := .venv
BIN := $(VENV)/bin
PIP ?= $(BIN)/python -m pip --disable-pip-version-check
WITH_PROGRESS := $(BIN)/python requirements/install.py
INSTALL := $(WITH_PROGRESS) $(PIP) install
RUN_STAMP := $(VENV)/.installed-run
DEV_STAMP := $(VENV)/.installed-dev
# The page is built by the Node that the build of the package requires; no other is used.
WEB := drivora_service/dashboard/web
PAGE_STAMP := $(VENV)/.built-page
# With the folders: a file that was removed counts as a change, too.
PAGE_SOURCES := $(shell find $(WEB) \( -name node_modules -o -name browser \) -prune -o -print)
PAGE_TOOLS_STAMP := $(WEB)/node_modules/.installed
NPM := $(BIN)/python -m tests.dashboard.npm

# Tests start many processes. Each would compile the sources anew where this is set, as in images.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help install install-dev page page-tools page-types demo test test-python python-tests test-slow test-faults test-browser benchmarks-short checks page-checks fast-tests kernels fuzz lint types contracts schema protocol networks docs-numbers api-examples pictures lock audit clean

help: ## Show the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | awk -F':.*## ' '{printf "  make %-12s %s\n", $$1, $$2}'

install: $(RUN_STAMP) $(PAGE_STAMP) ## Prepare .venv for running

install-dev: $(DEV_STAMP) ## Prepare .venv with the development tools, too

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "Drivora needs Python 3.11 or newer: make PYTHON=python3.12 ...")'
	@echo "Making $(VENV), an environment of Python"
	@$(PYTHON) -m venv $(VENV)

# Most modules of packages are never imported: compiling them all to bytecode takes twice the time of
# installing them, and 300 MB with those for development. Those that are used are compiled then.
$(RUN_STAMP): requirements/run.txt pyproject.toml | $(BIN)/python
	@$(INSTALL) --no-compile --require-hashes -r requirements/run.txt
# Before the installation, which would build it, too, but bury its errors in those of pip.
	@echo "Building the web page"
	@$(WITH_PROGRESS) $(BIN)/python drivora_service/dashboard/build.py
	@echo "Installing Drivora itself"
	@$(INSTALL) --no-compile --no-deps --no-build-isolation --editable .
	@$(BIN)/python -m drivora_service.system_libraries
	@touch $@

$(DEV_STAMP): requirements/dev.txt $(RUN_STAMP)
	@$(INSTALL) --no-compile --require-hashes -r requirements/dev.txt
	@touch $@

# Builds the page again if its sources have changed since the installation.
$(PAGE_STAMP): $(PAGE_SOURCES) | $(RUN_STAMP)
	@$(BIN)/python -m drivora_service.dashboard.build
	@touch $@

page: $(RUN_STAMP) ## Build the web page again
	@$(BIN)/python -m drivora_service.dashboard.build --again
	@touch $(PAGE_STAMP)

page-tools: $(PAGE_TOOLS_STAMP) ## Install the development tools of the page

$(PAGE_TOOLS_STAMP): $(WEB)/package-lock.json | $(RUN_STAMP)
	@$(NPM) ci --ignore-scripts
	@touch $@

page-types: $(DEV_STAMP) $(PAGE_TOOLS_STAMP) ## Rewrite the page's types of the API
	$(BIN)/python -m tests.dashboard.write_types

demo: $(RUN_STAMP) $(PAGE_STAMP) ## Judge scenarios on a shipped town, then search for failures
	$(BIN)/drivora demo

# The tests wait now and then: the checks fill that time, and are printed once they are done.
test: $(DEV_STAMP) ## Lint, types, import contracts, generated files, tests
	@$(MAKE) --no-print-directory --jobs=$(TEST_JOBS) --keep-going checks page-checks fast-tests

checks: $(DEV_STAMP)
	@failed=""; \
	printed=$$(mktemp); \
	for check in "ruff check ." "ruff format --check ." mypy lint-imports "drivora schema --check"; do \
	  echo "$$check" >> "$$printed"; \
	  $(BIN)/$$check >> "$$printed" 2>&1 || failed="$$failed, $$check"; \
	done; \
	cat "$$printed"; rm "$$printed"; \
	[ -z "$$failed" ] || { echo "failed: $${failed#, }"; exit 1; }

page-checks: $(DEV_STAMP) $(PAGE_TOOLS_STAMP)
	@failed=""; \
	printed=$$(mktemp); \
	for check in lint types test; do \
	  echo "page: $$check" >> "$$printed"; \
	  $(NPM) run $$check >> "$$printed" 2>&1 || failed="$$failed, $$check"; \
	done; \
	cat "$$printed"; rm "$$printed"; \
	[ -z "$$failed" ] || { echo "failed for the page: $${failed#, }"; exit 1; }

fast-tests: $(DEV_STAMP) $(PAGE_STAMP) kernels
	@$(BIN)/python -m pytest -n $(TEST_PROCESSES) --dist worksteal -m "not slow and not faults"

# Once, and not at the same time in each process of the tests.
kernels: $(DEV_STAMP)
	@$(BIN)/python -m drivora_service.worker.preloaded

# What another version of Python can change: types, numbers, documents, the database.
# The database is SQLite, which comes with Python; how PostgreSQL answers does not depend on it.
PYTHON_TESTS := tests/geometry tests/scenario tests/store tests/studies tests/suites/paired \
  tests/suites/gate tests/test_lock.py tests/test_parameters.py
test-python: $(DEV_STAMP) ## Types and the tests that a version of Python can change; CI runs it with a second one
	@$(MAKE) --no-print-directory --jobs=$(TEST_JOBS) --keep-going types python-tests

python-tests: $(DEV_STAMP)
	$(BIN)/python -m pytest -q -n $(TEST_PROCESSES) --dist worksteal -m "not slow and not faults" \
	  -k "not postgresql" $(PYTHON_TESTS)

test-slow: $(DEV_STAMP) $(PAGE_STAMP) kernels ## The slow tests, which CI runs, too
	$(BIN)/python -m pytest -n $(TEST_PROCESSES) --dist worksteal -m slow

INPUTS ?= 1000000
fuzz: $(DEV_STAMP) ## Fuzz the parsers: INPUTS=1000000, PARSER=name for one
	$(BIN)/python -m tests.fuzzing --inputs $(INPUTS) $(if $(PARSER),--parser $(PARSER))

# Each process of these tests has a service with two workers of its own, which are mostly idle.
test-faults: $(DEV_STAMP) ## Faults injected into a real service; TRIALS=20 at other random moments
	TRIALS=$(TRIALS) FAULT_TABLE=$(FAULT_TABLE) $(BIN)/python -m pytest -n 3 --dist worksteal \
	  -m faults tests/faults

# A real service with runs, campaigns and studies, and a real browser, which comes as a package.
test-browser: $(DEV_STAMP) $(PAGE_STAMP) $(PAGE_TOOLS_STAMP) kernels ## The page in a browser: pictures in build/screenshots
	@$(NPM) run test-browser

benchmarks-short: $(DEV_STAMP) kernels ## The benchmarks in their short form: build/benchmarks-short.json
	$(BIN)/python -m benchmarks --short

lint: $(DEV_STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(DEV_STAMP)
	$(BIN)/mypy

contracts: $(DEV_STAMP)
	$(BIN)/lint-imports

schema: $(DEV_STAMP) ## Regenerate the JSON Schemas
	$(BIN)/drivora schema --write

protocol: $(DEV_STAMP) ## Regenerate the code of the protocol for ADSs
	$(BIN)/python -m grpc_tools.protoc -I. --python_out=. --pyi_out=. --grpc_python_out=. \
	  drivora_service/agents/remote/agent.proto

networks: $(DEV_STAMP) ## Rebuild the shipped networks from their plain-XML sources
	$(BIN)/python -m drivora_service.networks.shipped_build

docs-numbers: $(DEV_STAMP) ## Rewrite the output of commands in README and tutorial
	$(BIN)/python -m tests.docs.rewrite

api-examples: $(DEV_STAMP) ## Record the answers in the API's documentation again
	$(BIN)/python -m tests.api.record_examples

pictures: $(DEV_STAMP) $(PAGE_STAMP) $(PAGE_TOOLS_STAMP) kernels ## Redraw the pictures of the documentation
	$(BIN)/python -m tests.docs.pictures

lock: $(DEV_STAMP) ## Resolve the pinned packages again
	for set in dev run build image; do \
	  case $$set in \
	    dev) flags="--extra cluster --extra networks --extra postgresql --group dev pyproject.toml" ;; \
	    run) flags="--group build --constraints requirements/dev.txt pyproject.toml" ;; \
	    build) flags="--group build --constraints requirements/dev.txt" ;; \
	    image) flags="--extra postgresql --constraints requirements/dev.txt pyproject.toml" ;; \
	  esac; \
	  $(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes \
	    --no-emit-index-url --no-emit-find-links --no-header --no-annotate \
	    --constraints requirements/bounds.in $$flags \
	    --output-file requirements/$$set.txt; \
	done

# Without --strict, packages that are unknown to the index would count as free of vulnerabilities.
ADVISORIES := https://api.osv.dev
audit: $(DEV_STAMP) ## Compare the pinned packages with known vulnerabilities (needs the internet)
	@$(BIN)/python -c "import httpx; httpx.get('$(ADVISORIES)', timeout=20)" 2>/dev/null || \
	  { echo "audit: NOT DONE: $(ADVISORIES), the service of advisories, cannot be reached. Run it on a machine with access"; exit 3; }
	for set in run dev; do \
	  $(BIN)/uv tool run --from pip-audit==2.10.0 pip-audit --strict --disable-pip --require-hashes \
	    --progress-spinner off --vulnerability-service osv -r requirements/$$set.txt || exit 1; \
	done

clean: ## Remove the virtual environment, the built page, and the caches
	rm -rf $(VENV) .mypy_cache .ruff_cache .pytest_cache
	rm -rf $(WEB)/node_modules drivora_service/dashboard/built
