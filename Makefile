# A thin front: each target installs what it needs, builds, runs. The builds are described by
# CMakePresets.json; everything lands in build/.
JOBS ?= $(shell nproc)
BIN := build/release/bin/cullhull
FUZZ_SECONDS ?= 60
FAST := -DCULLHULL_FAST_BUILD=ON
SUITES :=

.PHONY: help demo build test test-all bench docs fuzz format python clean wheel wheel-cuda sdist deb static \
  artifacts macos windows js
.NOTPARALLEL:

help:
	@echo "make demo     the hull of a LiDAR scan, certified, as a mesh in build/demo/"
	@echo "make build    $(BIN) and the libraries"
	@echo "make test     the tests of library, program, Python package and the pages' samples"
	@echo "make test-all every test; what make test has run here is not run again"
	@echo "make bench    build the benchmarks, run the smallest, and ours beside Qhull and CGAL"
	@echo "make docs     guides and reference as a site in build/docs/html/"
	@echo "make python   the Python package, installed into build/python/venv"
	@echo "make wheel    the Python package as one file for pip, in build/dist/ (sdist: its sources;"
	@echo "              wheel-cuda: with the CUDA backend)"
	@echo "make deb      Debian packages of program, shared library and headers, in build/dist/"
	@echo "make static   the program as one file for any Linux, in build/dist/"
	@echo "make artifacts  all of these, installed and run in empty Debian roots (as root)"
	@echo "make macos    library and program linked for macOS, in build/macos/ (not run)"
	@echo "make windows  program, DLL and wheel for Windows in build/windows/dist/, tested under wine"
	@echo "make js       the npm package, WebAssembly and its JavaScript, in build/wasm/js/"
	@echo "make fuzz     every fuzzer for FUZZ_SECONDS ($(FUZZ_SECONDS)) each"
	@echo "make format   clang-format over our sources"
	@echo "make clean    remove build/"

demo: build
	@mkdir -p build/demo
	$(BIN) hull data/autzen-150k.ply --certify -o build/demo/hull.ply -o build/demo/hull.json
	@echo "written: build/demo/hull.ply (a mesh), build/demo/hull.json (everything)"

build:
	@scripts/install-deps.sh build
	cmake --preset release $(FAST) -DCULLHULL_BUILD_TESTS=OFF -DCULLHULL_BUILD_BENCH=OFF \
	  -DCULLHULL_WITH_SUITES=$(if $(SUITES),ON,OFF)
	cmake --build build/release -j $(JOBS) --target cullhull_app $(SUITES)

test:
	@JOBS=$(JOBS) scripts/run-tests.sh short

test-all:
	@JOBS=$(JOBS) scripts/run-tests.sh all

bench:
	@scripts/install-deps.sh build bench
	cmake --preset release $(FAST) -DCULLHULL_BUILD_TESTS=OFF -DCULLHULL_BUILD_BENCH=ON
	cmake --build build/release -j $(JOBS)
	build/release/bin/micro_bench
	build/release/bin/cullhull-bench rivals

# The help of `cullhull-bench` is a page.
docs: SUITES := cullhull_bench_app
docs: build
	@scripts/install-deps.sh docs
	scripts/docs-site.sh build/docs $(BIN)
	@echo "written: build/docs/html/index.html"

python:
	@scripts/install-deps.sh build python
	scripts/python-venv.sh build/python
	@echo "try: build/python/venv/bin/python -m cullhull --help"

wheel wheel-cuda sdist:
	@scripts/install-deps.sh build python package
	scripts/artifacts.sh $@

deb static:
	@scripts/install-deps.sh build package
	scripts/artifacts.sh $@

artifacts:
	@scripts/install-deps.sh build python package roots
	scripts/artifacts.sh static wheels sdist deb sbom sums
	scripts/check-artifacts.sh

macos:
	@scripts/install-deps.sh build zig
	@JOBS=$(JOBS) scripts/cross-check.sh macos

windows:
	@scripts/install-deps.sh build windows
	JOBS=$(JOBS) scripts/windows.sh

js:
	@scripts/install-deps.sh build wasm
	@JOBS=$(JOBS) scripts/wasm.sh js

fuzz:
	@scripts/install-deps.sh build fuzz
	@scripts/fuzz.sh $(FUZZ_SECONDS)

format:
	@scripts/install-deps.sh format
	git ls-files '*.cpp' '*.hpp' '*.cu' '*.cuh' | xargs clang-format -i

clean:
	rm -rf build
