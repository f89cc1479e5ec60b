# Everything runs in .venv. What goes into it stands in requirements/, with hashes:
#   run.lock        what the robot, the learner and the graph need
#   dev.lock        the same, and what tests, lint and colcon need
#   build.lock      what builds sdists and the project itself, in environments of its own
#   installer.lock  uv, which installs the others

BIN := .venv/bin
READY := .venv/.ready-to-run
DEV := .venv/.ready-to-test

export VIRTUAL_ENV := $(CURDIR)/.venv
export UV_NO_CONFIG := 1
UV := .venv/installer/bin/uv

.DEFAULT_GOAL := help
.PHONY: help install dev run test thorough lint format bench docs colcon lock version clean

help:  ## list these targets
	@sed -nE 's/^([a-z]+):.*## (.*)/\1\t\2/p' $(MAKEFILE_LIST) | expand -t 10

install: $(READY)  ## create .venv with what `make run` needs, and the biped itself

dev: $(DEV)  ## add what `make test` needs: pytest, mypy, colcon, Pinocchio and others

run: $(READY)  ## see the walk fail, be learned on ROS 2, and be walked in real time
	@$(BIN)/biped demo

test: $(DEV)  ## run the tests
	$(BIN)/python -m pytest -n 2 --dist loadfile -m "not thorough"

thorough: $(DEV)  ## run the tests that show the same again under other conditions
	$(BIN)/python -m pytest -n 2 --dist loadfile -m thorough

lint: $(DEV)  ## check style, types and the direction of imports
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(DEV)  ## sort imports and lay out the code
	$(BIN)/ruff check --select I --fix .
	$(BIN)/ruff format .

bench: $(DEV)  ## time the simulation and the learner
	$(BIN)/python -m benchmarks

docs: $(DEV)  ## build the documentation site into site/; any warning is an error
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet

colcon: $(DEV)  ## build the ROS workspace into ros_ws/install
	cd ros_ws && $(CURDIR)/$(BIN)/colcon build

# Versions already in a lock stay as they are; `make lock UPGRADE=-U` renews them all.
COMPILE := UV_CUSTOM_COMPILE_COMMAND="make lock" $(UV) pip compile --quiet $(UPGRADE) \
	--python-version 3.11 --generate-hashes

lock: $(UV)  ## pin the dependencies of pyproject.toml, with hashes
	$(COMPILE) --output-file requirements/run.lock pyproject.toml
	$(COMPILE) --extra dev --constraint requirements/run.lock \
		--output-file requirements/dev.lock pyproject.toml
	$(COMPILE) --output-file requirements/build.lock requirements/build.in
	$(COMPILE) --output-file requirements/installer.lock requirements/installer.in

# It stands once per ROS package, since colcon reads no pyproject.toml.
version:  ## give the project and all its packages a version: make version TO=0.3.0
	sed -i -E 's/^(version: |version = "|    version="|  <version>)[0-9.]+/\1$(or $(TO),$(error say which: TO=0.3.0))/' \
		CITATION.cff pyproject.toml ros_ws/src/*/setup.py ros_ws/src/*/package.xml

clean:  ## remove .venv, caches and build products (recorded runs stay)
	rm -rf .venv build dist install log site ros_ws/build ros_ws/install ros_ws/log
	rm -rf .hypothesis .import_linter_cache .mypy_cache .pytest_cache .ruff_cache
	find . -type d \( -name __pycache__ -o -name '*.egg-info' \) -prune -exec rm -rf {} +

$(BIN)/python:
	@for python in python3.11 python3; do \
		if $$python -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' \
			2>/dev/null; then exec $$python -m venv .venv; fi; \
	done; \
	echo 'biped: no Python 3.11 found. PyBullet has no wheels for later ones; what' \
		'else there is to do: docs/install.md, "Other Pythons"' >&2; exit 1

# Stamps: each is as new as what was last installed from its prerequisites.
#
# Nothing is resolved here: with --no-deps, the very list of a lock is installed, whatever
# the index has got since. Settings of pip are not read, those of uv.toml are shut out,
# and the hashes leave no choice to what the environment may say (UV_DEFAULT_INDEX names
# a mirror). Not `uv pip sync`: it takes the egg-info in the wheels of ROS for packages
# that are not in the lock, and removes them.

$(UV): requirements/installer.lock | $(BIN)/python
	@$(BIN)/python -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' || \
		{ echo 'biped: .venv is not of Python 3.11; `make clean` removes it' >&2; \
		exit 1; }
	@$(BIN)/python -m pip install -qq --no-deps --require-hashes --only-binary :all: \
		--upgrade --target .venv/installer -r $<
	@touch $@

INSTALL = $(UV) pip install --quiet --no-deps --build-constraints requirements/build.lock
# The project itself, from the checkout. A package that misses another one is an error.
FINISH = $(INSTALL) --editable . && $(UV) pip check --quiet

$(READY): requirements/run.lock requirements/build.lock pyproject.toml $(UV)
	@echo 'installing what is locked in $< into .venv'
	@$(INSTALL) --require-hashes -r $< && $(FINISH)
	@touch $@

$(DEV): requirements/dev.lock requirements/build.lock pyproject.toml $(UV)
	@echo 'installing what is locked in $< into .venv'
	@$(INSTALL) --require-hashes -r $< && $(FINISH)
	@touch $(READY) $@
