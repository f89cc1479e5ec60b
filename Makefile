# Everything runs in .venv, which `make install` builds from requirements-dev.lock.

BIN := .venv/bin
READY := .venv/.installed
OUT := bags/quick

.DEFAULT_GOAL := help
.PHONY: help install run test lint format bench colcon lock clean

help:  ## list these targets
	@sed -nE 's/^([a-z]+):.*## (.*)/\1\t\2/p' $(MAKEFILE_LIST) | expand -t 10

install: $(READY)  ## create .venv with the locked packages and the biped itself

run: $(READY)  ## learn a walk on ROS 2, walk it in real time, draw its ZMP
	$(BIN)/biped up --preset quick --fresh --publish-every 10 --out $(OUT)
	$(BIN)/biped up --greedy --pace realtime --out $(OUT)
	$(BIN)/biped walk --memory $(OUT)/memory.npz --figure $(OUT)/zmp.png

test: $(READY)  ## run the tests
	$(BIN)/python -m pytest -n 2 --dist loadfile

lint: $(READY)  ## check style, types and the direction of imports
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(READY)  ## sort imports and lay out the code
	$(BIN)/ruff check --select I --fix .
	$(BIN)/ruff format .

bench: $(READY)  ## time the simulation and the learner
	$(BIN)/python -m benchmarks

colcon: $(READY)  ## build the ROS workspace into ros_ws/install
	cd ros_ws && $(CURDIR)/$(BIN)/colcon build

# Versions already in a lock stay as they are; `make lock UPGRADE=-U` renews them all.
# Local pip settings are shut out, so that nothing of this machine gets into a lock.
COMPILE := CUSTOM_COMPILE_COMMAND="make lock" PIP_CONFIG_FILE=/dev/null PIP_FIND_LINKS= \
	$(BIN)/pip-compile --quiet $(UPGRADE) --generate-hashes --allow-unsafe \
	--strip-extras --no-emit-index-url --no-emit-find-links --no-emit-trusted-host

lock: $(READY)  ## pin the dependencies of pyproject.toml, with hashes
	$(COMPILE) --output-file requirements.lock pyproject.toml
	$(COMPILE) --extra dev --constraint requirements.lock \
		--output-file requirements-dev.lock pyproject.toml

clean:  ## remove .venv, caches and build products (recorded runs stay)
	rm -rf .venv build dist install log ros_ws/build ros_ws/install ros_ws/log
	rm -rf .hypothesis .import_linter_cache .mypy_cache .pytest_cache .ruff_cache
	find . -type d \( -name __pycache__ -o -name '*.egg-info' \) -prune -exec rm -rf {} +

$(BIN)/python:
	@for python in python3.11 python3; do \
		if $$python -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' \
			2>/dev/null; then exec $$python -m venv .venv; fi; \
	done; \
	echo 'biped: no Python 3.11 found, and the locked packages need it' >&2; exit 1

# Stamps: each is as new as what was last installed from its prerequisites.

.venv/.locked: requirements-dev.lock | $(BIN)/python
	@echo 'installing the locked packages into .venv'
	@$(BIN)/python -m pip install --quiet --require-hashes -r requirements-dev.lock
	@touch $@

.venv/.installed: pyproject.toml .venv/.locked
	@$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation -e .
	@touch $@
