# make demo | test | lint | extension | bench      BPY=5.0.1 picks another Blender, PYTHON=python3.13 another Python
PYTHON ?= python3.11
BPY ?= 4.5.15
VENV ?= .venv$(if $(filter-out 4.5.15,$(BPY)),-$(BPY))
BIN := $(VENV)/bin
READY := $(VENV)/.ready
WORKERS ?= 2

.PHONY: demo test lint extension bench clean

demo: $(READY)
	$(BIN)/unisg demo --out demo

test: $(READY)
	$(BIN)/python -m pytest -n $(WORKERS) --dist loadfile $(TESTS)

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

extension: $(READY)
	$(BIN)/python packaging/build_extension.py

bench: $(READY)
	$(BIN)/unisg benchmark poses --out build/benchmarks/poses

# torch first and by itself: its exact version decides which build the others find installed
$(READY): pyproject.toml constraints.txt
	test -d $(VENV) || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet "torch==2.13.0"
	$(BIN)/python -m pip install --quiet --constraint constraints.txt "bpy==$(BPY)" --editable ".[ga,learn,cluster,blender,figures,dev]"
	touch $(READY)

clean:
	rm -rf build demo .venv .venv-*
