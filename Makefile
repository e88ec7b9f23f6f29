# Two commands on a fresh machine:   make demo     make test
# Python 3.11 gets bpy 5.0.1, Python 3.13 gets bpy 5.2.x. Name another one with PYTHON=/path/to/python.

PYTHON ?= $(shell for p in python3.11 python3.13 python3 python; do \
	command -v $$p >/dev/null 2>&1 && $$p -c 'import sys; sys.exit(sys.version_info[:2] not in ((3, 11), (3, 13)))' 2>/dev/null \
	&& { command -v $$p; break; }; done)
VENV := .venv
PEERS := .venv-peers
RUN := $(VENV)/bin
OUT ?= out/demo
BLENDER ?= blender
JOBS ?= 2

.PHONY: demo test test-peers setup-peers lint setup extension test-desktop screenshots benchmark layout-table ablations clean

demo: setup
	$(RUN)/code-as-room samples/bedroom/picture.png --replies samples/bedroom/replies --out $(OUT)

# Two processes side by side; a test file stays in one of them.
test: setup
	$(RUN)/python -m pytest -n $(JOBS) --dist loadfile --no-loadscope-reorder

# Our model clients beside the vendors' own libraries and a real llama.cpp server; an environment of its own, without Blender.
test-peers: setup-peers
	CODE_AS_ROOM_PEERS=1 $(PEERS)/bin/python -m pytest -o faulthandler_timeout=900 --durations=3 tests/peers

setup-peers: $(PEERS)/.ready

# The clone's folder may have any name, so the type checker sees the package through a link that has the right one.
lint: setup
	$(RUN)/ruff check .
	$(RUN)/ruff format --check .
	@mkdir -p build/types && ln -sfn ../.. build/types/code_as_room
	MYPYPATH=build/types $(RUN)/mypy -p code_as_room.pipeline -p code_as_room.operators -p code_as_room.panels

benchmark: setup
	$(RUN)/python -m benchmark.interpreter
	$(RUN)/python -m benchmark.stages
	$(RUN)/code-as-room samples/bedroom/picture.png --replies samples/bedroom/replies --out out/benchmark
	$(RUN)/python -m benchmark.layout out/benchmark/scene.json samples/bedroom/truth.json out/benchmark/memory.json
	$(RUN)/python -m benchmark.furnished out/benchmark --truth samples/bedroom/truth.json
	$(RUN)/python -m benchmark.colours out/benchmark
	$(RUN)/python -m benchmark.room_size out/benchmark
	-$(RUN)/python -m benchmark.finishing
	-$(RUN)/python -m benchmark.client_speed
	-$(RUN)/python -m benchmark.fuzz --replies 100000 --minutes 25 --processes $(JOBS)

# Stages 1 to 4 replayed from the recordings of our own pictures, scored beside the direct answer.
layout-table: setup
	$(RUN)/python -m benchmark.replay --out out/replay

# The same with one thing left out at a time, and with noisier models; takes long.
ablations: setup
	$(RUN)/python -m benchmark.ablations benchmark/recordings --out out/ablations --seeds 2 --jobs $(JOBS)

# One zip a platform, with the wheels that Blender lacks, built and validated by Blender's own packager.
extension: setup
	$(RUN)/python tools/build_extension.py --out dist

# In the real window: BLENDER is the program, or a command line that starts it.
test-desktop: setup
	$(RUN)/python tests/desktop/run_panel.py --blender "$(BLENDER)"

screenshots: setup
	$(RUN)/python tests/desktop/take_screenshots.py --blender "$(BLENDER)" --out docs/pictures

setup: $(VENV)/.ready

$(VENV)/.ready: pyproject.toml
	@if [ -z "$(PYTHON)" ]; then \
	echo "Code-as-Room needs Python 3.11 (for bpy 5.0) or Python 3.13 (for bpy 5.2), and found neither."; \
	echo "Install one of them (python.org, your package manager or pyenv), then run this again,"; \
	echo "or name it: make $(MAKECMDGOALS) PYTHON=/path/to/python3.11"; exit 1; fi
	@echo "Setting up $(VENV) with $(PYTHON); the first time takes a few minutes and about 1.5 GB."
	@$(PYTHON) -m venv $(VENV) || { echo "The venv module is missing: on Debian and Ubuntu, install python3-venv."; exit 1; }
	@$(RUN)/python -m pip install --quiet --disable-pip-version-check --editable '.[blender,dev]'
	@$(RUN)/python -c 'import bpy' || { \
	echo "bpy was installed but cannot be loaded: system libraries are missing."; \
	echo "On Debian and Ubuntu: apt-get install libx11-6 libxi6 libxrender1 libxfixes3 libxkbcommon0 libsm6 libgl1 libegl1 libgl1-mesa-dri"; exit 1; }
	@touch $@

$(PEERS)/.ready: pyproject.toml requirements/peers.txt $(VENV)/.ready
	@$(RUN)/python -m venv $(PEERS)
	@$(PEERS)/bin/python -m pip install --quiet --disable-pip-version-check --editable '.[peers]'
	@$(PEERS)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps -r requirements/peers.txt
	@touch $@

clean:
	rm -rf $(VENV) $(PEERS) out build *.egg-info
