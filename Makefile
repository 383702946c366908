# BPY=5.0.1 picks another Blender, PYTHON=python3.13 another Python, TESTS=tests/poses one room's tests
PYTHON ?= python3.11
BPY ?= 4.5.15
VENV ?= .venv$(if $(filter-out 4.5.15,$(BPY)),-$(BPY))
BIN := $(VENV)/bin
READY := $(VENV)/.ready
WORKERS ?= 2
BENCH ?= poses
BLENDER ?= blender
FOLDER ?= build/window
PYTEST := $(BIN)/python -m pytest -n $(WORKERS) --dist loadfile

.PHONY: help demo test test-fast test-zip coverage lint extension bench bench-all docs notebooks pictures hooks player test-web test-window clean

help:  ## say what can be made
	@grep -E '^[a-z-]+:.*##' $(firstword $(MAKEFILE_LIST)) | sed -E 's/:[^#]*## */\t/' | expand -t 14
	@head -1 $(firstword $(MAKEFILE_LIST))

demo: $(READY)  ## the whole job once: an operating room, its dataset, objects added -> demo/
	$(BIN)/unisg demo --out demo

test: $(READY)  ## every test, and which were the slowest
	$(PYTEST) --durations=15 $(TESTS)

test-fast: $(READY)  ## the tests without those marked slow: under two minutes on two cores
	$(PYTEST) -m "not slow" $(TESTS)

test-zip: extension  ## what touches Blender or infers, on the zips' own code and wheels, for each Python that is there
	$(BIN)/python packaging/check_zip.py

coverage: $(READY)  ## every test, and the lines that none of them runs -> build/coverage/
	$(PYTEST) --cov=unisg_blender --cov-report=term --cov-report=html:build/coverage $(TESTS)

lint: $(READY)  ## ruff, its formatter, mypy
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/python packaging/check_types.py

extension: $(READY)  ## the zips for Blender, validated -> build/extension/
	$(BIN)/python packaging/build_extension.py

bench: $(READY)  ## one benchmark of the command line, BENCH=poses unless another is named -> build/benchmarks/
	$(BIN)/unisg benchmark $(BENCH) --out build/benchmarks/$(BENCH)

bench-all: $(READY)  ## the benchmarks that need no data, small, and what changed since the last run -> build/benchmarks/
	$(BIN)/python benchmarks/run.py --quick --out build/benchmarks

docs: $(READY)  ## what is written by scripts in docs/, and the site of it, links checked -> docs/, build/site/index.html
	$(BIN)/python packaging/draw_architecture.py
	$(BIN)/python packaging/write_api_page.py
	$(BIN)/python packaging/write_command_page.py
	$(BIN)/python packaging/page_numbers.py
	$(BIN)/python packaging/build_site.py

notebooks: $(READY)  ## run the notebooks, and write what they print and draw into them -> docs/notebooks/
	$(BIN)/python packaging/run_notebooks.py

pictures: $(READY)  ## those of README.md and the guide: BLENDER=/path/to/blender, as for test-window -> docs/pictures/
	$(BIN)/python packaging/guide_pictures.py
	UNISG_PICTURES=docs/pictures UNISG_BLENDER="$(BLENDER)" UNISG_WINDOW_FOLDER="$(FOLDER)" $(BIN)/python -m pytest -rs tests/window/test_window_pictures.py

hooks: $(READY)  ## let git run what `make lint` runs before each commit
	$(BIN)/pre-commit install

# torch first and by itself: its exact version decides which build the others find installed
$(READY): pyproject.toml constraints.txt
	test -d $(VENV) || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet "torch==2.13.0"
	$(BIN)/python -m pip install --quiet --constraint constraints.txt "bpy==$(BPY)" --editable ".[ga,learn,cluster,judge,blender,figures,docs,dev]"
	touch $(READY)

player:  ## the script of the page in which lessons are played, from npm -> unisg_blender/web/player.js
	cd packaging/player && npm install --no-audit --no-fund && npx esbuild main.js --bundle --minify --format=iife \
		--legal-comments=none --outfile=../../unisg_blender/web/player.js

test-web: $(READY)  ## plays a lesson in Chromium (Debian: chromium, npm) and lets `unisg simulate` judge what it saved
	cd packaging/player && npm install --no-audit --no-fund
	UNISG_PLAYER=packaging/player $(PYTEST) tests/web

test-window: $(READY)  ## places, generates, plays in a real window: BLENDER=/path/to/blender (Debian: xvfb, xdotool, imagemagick)
	UNISG_BLENDER="$(BLENDER)" UNISG_WINDOW_FOLDER="$(FOLDER)" $(BIN)/python -m pytest -rs tests/window

clean:  ## take away everything that was made here
	rm -rf build demo .venv .venv-*
