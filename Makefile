# Every command does its own set-up: a .venv in this folder, made from PYTHON (3.11 or newer).
PYTHON ?= $(shell for p in python3.14 python3.13 python3.12 python3.11 python3; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && { echo $$p; break; }; done)
BIN := .venv/bin

.PHONY: demo test test-all check scripts release-check coverage docs links play screenshots charts languages page-script wasm bench over-time clean help
help:
	@echo "make demo   render the first scene of the paper to out/, with its table of results"
	@echo "make check  format, types (of the scripts of pages too, where node is installed), layers, links: a minute at the most"
	@echo "make test   every behaviour: five minutes"
	@echo "make test-all   both, and browsers, wheel, documentation, layouts in every language, Dask, other processors"
	@echo "make coverage   branches of the kernels that the tests take"
	@echo "make release-check   test-all, and no message that waits for a translation"
	@echo "make docs   build the documentation in out/docs, warnings are errors"
	@echo "make links  check the links of the documentation to other sites"
	@echo "make bench  measure speed against accuracy, and against peers where installed"
	@echo "make over-time  the same numbers for each release, by asv: keep those of this commit in benchmarks/releases"
	@echo "make play   open the sandbox window"
	@echo "make languages   update the catalogues of messages, for window and pages, and count missing translations"
	@echo "make page-script   minify the scripts of pages, after a change of assets/page: assets/page.min.js"
	@echo "make wasm   compile the kernels for browsers anew, after a change of their digits: assets/page/kernels.wasm"
	@echo "make screenshots   pictures of the window, of a page and of films, for README and documentation"
	@echo "make charts   the chart and the maps of stability, for the same"

.venv/.installed: pyproject.toml
	@test -n "$(PYTHON)" || { echo "softcradle needs Python 3.11 or newer; set PYTHON=..."; exit 2; }
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet --editable '.[dev]'
	@mkdir -p .venv/typed/softcradle # the package in one folder, as the wheel has it, for tools that read and do not run
	@ln -sfn ../../../softcradle/__init__.py .venv/typed/softcradle/__init__.py
	@ln -sfn ../../../softcradle/__main__.py .venv/typed/softcradle/__main__.py
	@for room in physics scenes sandbox; do ln -sfn ../../../$$room .venv/typed/softcradle/$$room; done
	@touch $@

demo: .venv/.installed
	@mkdir -p out
	$(BIN)/softcradle render one-on-four -o out/one-on-four.mp4
	$(BIN)/softcradle run one-on-four -o out/one-on-four.csv > out/one-on-four.txt
	@cat out/one-on-four.txt

test: .venv/.installed # kernels are compiled first, side by side: test processes would each compile all of them
	@$(BIN)/python -c "import softcradle; softcradle.warm(['accurate', 'ensemble_ends'])" & \
	$(BIN)/python -c "import softcradle; softcradle.warm([m.name for m in softcradle.METHODS if not m.adaptive] + ['SoftChain'])"; wait
	SDL_VIDEODRIVER=dummy SDL_AUDIODRIVER=dummy $(BIN)/python -m pytest -n 2 --dist worksteal -m "not slow"

test-all: check test
	SDL_VIDEODRIVER=dummy SDL_AUDIODRIVER=dummy $(BIN)/python -m pytest -n 2 --dist worksteal -m slow

coverage: .venv/.installed # branches of the kernels, as plain Python, that the tests of single kernels and of short motions take
	@mkdir -p out/coverage
	NUMBA_DISABLE_JIT=1 COVERAGE_CORE=ctrace SDL_VIDEODRIVER=dummy $(BIN)/coverage run \
		-m pytest -q -n 0 -p no:cacheprovider -m "not slow" @tests/physics/kernel_tests.txt
	$(BIN)/coverage report --fail-under 95

release-check: test-all
	$(BIN)/python -m tools.update_catalogues --complete

check: .venv/.installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/python -m tools.plain_language
	cd .venv/typed && ../bin/lint-imports --config ../../pyproject.toml --no-cache --no-logo
	$(BIN)/python -m pytest -q -n 0 -p no:cacheprovider tests/house/test_links.py
	@if command -v npm > /dev/null; then $(MAKE) --no-print-directory scripts; else \
		echo "the scripts of pages are not checked: that needs node and npm"; fi

scripts: node_modules # linter and types of the scripts of pages
	npx eslint assets/page
	npx tsc

node_modules: package.json
	npm install --no-package-lock --no-audit --no-fund --silent
	@touch $@

.venv/.docs: .venv/.installed
	$(BIN)/python -m pip install --quiet --editable '.[docs]'
	@touch $@

docs: .venv/.docs
	@echo "compiling kernels first, minutes on a new machine; the examples of the pages are tested by make test-all"
	@$(BIN)/softcradle warm
	$(BIN)/python -m sphinx --fail-on-warning --keep-going -q -b html docs out/docs

links: .venv/.docs # needs the network, so it is no part of the tests
	$(BIN)/python -m sphinx -q -b linkcheck docs out/links

bench: .venv/.installed
	$(BIN)/python -m benchmarks

over-time: .venv/.installed # half an hour: asv makes an environment, compiles, measures; what did not run fails the test
	$(BIN)/python -m pip install --quiet --editable '.[bench]'
	test -f $(HOME)/.asv-machine.json || $(BIN)/asv machine --yes
	$(BIN)/asv run --show-stderr "HEAD^!"
	$(BIN)/python -m pytest -q -n 0 tests/house/test_benchmarks.py -k kept
	$(BIN)/asv publish

play: .venv/.installed
	$(BIN)/softcradle

screenshots: .venv/.installed
	SDL_VIDEODRIVER=dummy $(BIN)/python -m tools.screenshots docs/window
	$(BIN)/python -m tools.page_pictures docs/page
	SDL_VIDEODRIVER=dummy $(BIN)/softcradle render one-on-four -o docs/one-on-four.png
	SDL_VIDEODRIVER=dummy $(BIN)/softcradle render draft-gear-two-on-two --size 960x480 -o docs/two-on-two.kymograph.png

charts: .venv/.installed # minutes; other people's integrators are on the chart where they are installed: pip install -e '.[peers]'
	@mkdir -p out
	$(BIN)/softcradle stability -o out/stability.png
	$(BIN)/softcradle chart one-on-5 -o out/chart.png
	cp out/stability.png out/chart.png docs/

languages: .venv/.installed
	$(BIN)/python -m tools.update_catalogues

page-script: .venv/.installed # needs node
	$(BIN)/python -m tools.page_script

wasm: .venv/.installed # a minute; all else reads the file that is kept
	$(BIN)/python -m pip install --quiet --editable '.[wasm]'
	$(BIN)/python -m tools.wasm_kernels
	$(BIN)/python -m tools.same_digits

clean:
	rm -rf .venv out dist
