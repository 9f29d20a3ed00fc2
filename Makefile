# Both commands do their own set-up: a .venv in this folder, made from PYTHON (3.11 or newer).
PYTHON ?= $(shell for p in python3.14 python3.13 python3.12 python3.11 python3; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && { echo $$p; break; }; done)
BIN := .venv/bin

.PHONY: demo test check play screenshots bench clean help
help:
	@echo "make demo   render the first scene of the paper to out/, with its table of results"
	@echo "make test   run the whole test suite"
	@echo "make check  linter, formatter and type checker"
	@echo "make bench  measure speed against accuracy, and against peers where installed"
	@echo "make play   open the sandbox window"
	@echo "make screenshots   pictures of the window, for this README"

.venv/.installed: pyproject.toml
	@test -n "$(PYTHON)" || { echo "softcradle needs Python 3.11 or newer; set PYTHON=..."; exit 2; }
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet --editable '.[dev]'
	@touch $@

demo: .venv/.installed
	@mkdir -p out
	$(BIN)/softcradle render one-on-four -o out/one-on-four.mp4
	$(BIN)/softcradle run one-on-four -o out/one-on-four.csv > out/one-on-four.txt
	@cat out/one-on-four.txt

test: .venv/.installed
	SDL_VIDEODRIVER=dummy SDL_AUDIODRIVER=dummy $(BIN)/python -m pytest -n 2 --dist loadfile

check: .venv/.installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	@mkdir -p .venv/typed/softcradle # type checkers want the package in one folder, as the wheel has it
	@ln -sfn $(CURDIR)/softcradle/__init__.py .venv/typed/softcradle/__init__.py
	@ln -sfn $(CURDIR)/softcradle/__main__.py .venv/typed/softcradle/__main__.py
	@for room in physics scenes sandbox; do ln -sfn $(CURDIR)/$$room .venv/typed/softcradle/$$room; done
	MYPYPATH=.venv/typed $(BIN)/mypy

bench: .venv/.installed
	$(BIN)/python -m benchmarks

play: .venv/.installed
	$(BIN)/softcradle

screenshots: .venv/.installed
	SDL_VIDEODRIVER=dummy $(BIN)/python -m softcradle.sandbox.window.screenshots docs/window

clean:
	rm -rf .venv out dist
