# KINDYNA. The two commands of a user are `make run` and `make test`; both set everything up by themselves.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.ONESHELL:
.DELETE_ON_ERROR:
.SUFFIXES:
MAKEFLAGS += --no-builtin-rules
.DEFAULT_GOAL := help

PYTHON ?= python3
ARGS ?=

# What the wheels of Qt expect of the system. `make run SYSTEM_PACKAGES=` leaves the system alone.
SYSTEM_PACKAGES := \
	libegl1 libgl1 libglib2.0-0 libdbus-1-3 libfontconfig1 libxkbcommon0 \
	libxcb-cursor0 libxcb-icccm4 libxcb-keysyms1 libxkbcommon-x11-0 libxcb-shape0 \
	fonts-dejavu-core fonts-nanum
# What the tests of a real window need besides; without it they are skipped.
TEST_PACKAGES := xvfb xauth
# Twice as quick at fifty digits; mpmath takes it up where it is there.
TEST_ARITHMETIC := gmpy2>=2.2,<3

# Nothing in the caller's environment may bend the interpreter, pip or pytest.
unexport PYTHONPATH PYTHONHOME PYTHONSTARTUP PYTHONOPTIMIZE PYTHONWARNINGS PYTHONSAFEPATH PYTHONPLATLIBDIR
unexport PYTHONINSPECT PYTHONDONTWRITEBYTECODE PYTHONPYCACHEPREFIX VIRTUAL_ENV __PYVENV_LAUNCHER__ PYTEST_ADDOPTS PYTEST_PLUGINS
unexport PIP_TARGET PIP_PREFIX PIP_ROOT PIP_REQUIRE_VIRTUALENV PIP_PYTHON
export PIP_USER := 0
export PYTHONNOUSERSITE := 1

# install_packages NAMES: install those that are missing, on a Debian-like system where we may; else name them.
define INSTALL_PACKAGES
install_packages() {
    local package status missing=() as_root=() log
    command -v dpkg-query >/dev/null || return 0
    for package in "$$@"; do
        status=$$(dpkg-query -W -f ' $${db:Status-Status} ' "$$package" "$${package}t64" 2>/dev/null) || true
        [[ $$status == *' installed '* ]] || missing+=("$$package")
    done
    [ $${#missing[@]} -gt 0 ] || return 0
    if [ "$$(id -u)" -ne 0 ]; then as_root=(sudo -n); fi
    if ! command -v apt-get >/dev/null || ! "$${as_root[@]}" true 2>/dev/null; then
        echo "Missing system packages (to be installed by an administrator): $${missing[*]}" >&2
        return 0
    fi
    echo "Installing system packages: $${missing[*]}"
    log=$$(mktemp)
    as_root+=(env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=120)
    if ! { { [ -n "$${lists_updated:-}" ] || "$${as_root[@]}" update; } &&
            lists_updated=yes &&
            "$${as_root[@]}" install --no-install-recommends "$${missing[@]}"; } </dev/null >"$$log" 2>&1; then
        grep -E '^(E:|Err:)' "$$log" >&2 || tail -n 5 "$$log" >&2
        echo "Could not install these system packages, going on without: $${missing[*]}" >&2
    fi
    rm -f "$$log"
}
endef

# A moved checkout, or a Python that has gone, makes an environment useless: then it is made anew.
VENV_HOME := $(shell test -x .venv/bin/python && cat .venv/.ready 2>/dev/null)
ifneq ($(VENV_HOME),$(CURDIR))
.PHONY: .venv/.ready
endif

.PHONY: help run test test-web check docs bench bench-check stress fuzz soak wheel clean

help:
	@cat <<-'END'
	make run      start KINDYNA
	make test     run the tests (make test ARGS="-k profile" selects some)
	make test-web the web page in a browser (installs Debian's chromium where it may)
	make check    lint, import contracts, types
	make docs     build the pages out/docs/index.html: guide, library, gallery, notebooks, tables
	make bench    measure speed against error (out/bench; ARGS=--quick; ARGS=--readme: into help and README)
	make bench-check  fail where a kernel is slower by its rival than its limit (tests/benchmarks/limits.json)
	make stress   the long tests, and a search for numerical breakdown (KINDYNA_STRESS_SECONDS, default 600)
	make fuzz     use the window at random and kill it at random (KINDYNA_FUZZ_SECONDS, default 600); seek in 300 random designs, 3,000 at once
	make soak     run the window for minutes and look for leaks
	make wheel    build the wheel and the source distribution in dist, and test them in an empty environment
	make clean    remove the environment, caches and dist
	END

# The stamp is written last and removed first: whatever is interrupted starts from nothing the next time.
.venv/.ready: pyproject.toml Makefile
	@$(INSTALL_PACKAGES)
	exec 9<Makefile
	! command -v flock >/dev/null || flock 9
	if [ -x .venv/bin/python ] && [ "$$(cat .venv/.ready 2>/dev/null)" = "$$(pwd -P)" ]; then
	    if [ .venv/.ready -nt pyproject.toml ] && [ .venv/.ready -nt Makefile ]; then exit 0; fi
	    usable=yes
	else
	    usable=no
	fi
	rm -f .venv/.ready
	if ! $(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))'; then
	    echo "KINDYNA needs Python 3.11 or newer; name one with make PYTHON=..." >&2
	    exit 1
	fi
	needed=($(SYSTEM_PACKAGES))
	can_create() { $(PYTHON) -c 'import ensurepip, venv' 2>/dev/null; }
	if [ $$usable = no ] && ! can_create; then needed=(python3-venv "$${needed[@]}"); fi
	install_packages "$${needed[@]}"
	if [ $$usable = no ]; then
	    if ! can_create; then
	        echo "Without Python's modules venv and ensurepip there is no environment to install KINDYNA in" >&2
	        exit 1
	    fi
	    echo "Creating the Python environment .venv"
	    $(PYTHON) -m venv --clear .venv || { rm -rf .venv; exit 1; }
	fi
	echo "Installing the Python packages (a few hundred megabytes the first time)"
	.venv/bin/python -m pip install -qq --disable-pip-version-check --no-input -e '.[dev]'
	pwd -P > .venv/.ready

.venv/.test-packages: .venv/.ready
	@$(INSTALL_PACKAGES)
	install_packages $(TEST_PACKAGES)
	.venv/bin/python -m pip install -qq --disable-pip-version-check --no-input --retries 1 --only-binary :all: '$(TEST_ARITHMETIC)' ||
	    echo "Could not install $(TEST_ARITHMETIC), going on without: the tests take longer" >&2
	touch .venv/.test-packages

run: .venv/.ready
	@.venv/bin/kindyna $(ARGS)

test: .venv/.ready .venv/.test-packages
	@.venv/bin/python -m pytest -q -n auto --maxprocesses 4 --dist worksteal $(ARGS)

check: .venv/.ready
	@.venv/bin/ruff check
	@.venv/bin/ruff format --check --quiet
	.venv/bin/lint-imports --no-logo
	# Types on the three systems at the same time, each with its own cache.
	runs=()
	for system in linux win32 darwin; do
	    cache=.mypy_cache/$$system
	    if [ $$system = linux ]; then cache=.mypy_cache; fi
	    .venv/bin/mypy --platform $$system --cache-dir $$cache | sed "s/^/$$system: /" &
	    runs+=($$!)
	done
	for run in "$${runs[@]}"; do wait "$$run"; done
	.venv/bin/python -B .ci/docs/typed.py

.venv/.docs-packages: .venv/.ready
	@echo "Installing the packages that the pages need"
	.venv/bin/python -m pip install -qq --disable-pip-version-check --no-input -e '.[dev,docs]'
	touch .venv/.docs-packages

# Without bytecode, so that nothing is written but out/.
docs: .venv/.docs-packages
	@.venv/bin/python -B .ci/docs/build.py
	@echo "The pages are in out/docs/index.html"

# What the benchmark compares with. Where it cannot be had, its rows say so.
.venv/.bench-packages: .venv/.ready
	@echo "Installing the packages that the benchmark compares with"
	if .venv/bin/python -m pip install -qq --disable-pip-version-check --no-input --retries 1 -e '.[dev,bench]'; then
	    touch .venv/.bench-packages
	else
	    echo "Could not install them, going on without" >&2
	fi

bench: .venv/.bench-packages
	@.venv/bin/python tests/benchmarks/run.py $(ARGS)

bench-check: .venv/.ready
	@.venv/bin/python tests/benchmarks/run.py --check $(ARGS)

test-web: .venv/.ready .venv/.test-packages
	@$(INSTALL_PACKAGES)
	install_packages chromium
	.venv/bin/python -m pytest -q tests/core/output/test_web.py $(ARGS)

stress: export KINDYNA_STRESS_SECONDS ?= 600
stress: .venv/.ready .venv/.test-packages
	@.venv/bin/python -m pytest -q -m stress -n auto --maxprocesses 4 --dist worksteal $(ARGS)

fuzz: export KINDYNA_FUZZ_SECONDS ?= 600
fuzz: .venv/.ready
	@.venv/bin/python -m pytest -q -m fuzz $(ARGS)

soak: .venv/.ready
	@.venv/bin/python -m pytest -q -m soak $(ARGS)

wheel: .venv/.ready
	@rm -rf dist
	.venv/bin/python -m hatchling build -d dist
	.venv/bin/python -m pytest -q -m wheel tests/core/public $(ARGS)

clean:
	@rm -rf .venv dist build .pytest_cache .ruff_cache .mypy_cache .import_linter_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
