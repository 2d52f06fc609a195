# make demo   plans a shipped drawing and says where the picture is
# make test   lint, types, tests
# make bench  timings: figure, target, met or not
# Everything that is needed is installed into .venv (and uv into .tools when it is missing).

UV := $(shell command -v uv || echo .tools/bin/uv)
RUN := .venv/bin/
export UV_PYTHON_DOWNLOADS := never
# trust what the machine trusts, also behind a company's proxy (the second name is that of older versions)
export UV_SYSTEM_CERTS := 1
export UV_NATIVE_TLS := 1
# warnings of installed packages are not ours to fix
export PYTHONWARNINGS :=

.PHONY: demo test lint types tests bench format wheel clean

demo: .venv/.ready
	$(RUN)optplan demo drawing --output out/demo --force

test: lint types tests

lint: .venv/.ready
	$(RUN)ruff check .
	$(RUN)ruff format --check .

types: .venv/.ready
	$(RUN)mypy

tests: .venv/.ready
	$(RUN)pytest -n 2

bench: .venv/.ready
	-$(MAKE) --no-print-directory .peers/.ready
	-$(RUN)python -m benchmarks
	-$(RUN)python -m benchmarks.connectors
	-$(RUN)python -m benchmarks.fields
	-$(RUN)python -m benchmarks.driving
	-$(RUN)python -m benchmarks.speed
	-$(RUN)python -m benchmarks.facades
	$(RUN)python -m benchmarks.ordering

format: .venv/.ready
	$(RUN)ruff check --fix .
	$(RUN)ruff format .

wheel: .venv/.ready
	$(UV) build --wheel --out-dir dist

clean:
	rm -rf .venv .tools .peers .mypy_cache .pytest_cache .ruff_cache .hypothesis .numba_cache dist out

# a system pip that refuses to install (PEP 668) still fills a folder of ours
.tools/bin/uv:
	python3 -m pip install --quiet --disable-pip-version-check --target .tools uv

.venv/.ready: pyproject.toml uv.lock | $(UV)
	$(UV) sync --frozen --quiet --compile-bytecode
	@touch $@

# other programs to measure with, in an environment of their own: or-tools and highspy cannot share a process
.peers/.ready: | $(UV)
	$(UV) venv --quiet --clear --python python3 .peers
	$(UV) pip install --quiet --python .peers/bin/python ortools pyvrp
	@touch $@
