#!/usr/bin/env bash
# The package in FOLDER/venv, and its tests there:
#
#     run.sh FOLDER [PYTEST ARGUMENTS...]    all of the following
#     run.sh FOLDER --install                the package, and what `make test` needs of PyPI
#     run.sh FOLDER --extras                 the other packages that its tests use
#     run.sh FOLDER --part short             what `make test` runs; notes in FOLDER/passed what passed
#     run.sh FOLDER --part own|foreign       the tests of our own that are not noted there; the files
#                                            named below, most of them other projects' own tests
#     run.sh --short-files                   prints the files of the part `short`
#
# Exit status 77: PyPI is out of reach, or this machine cannot make a virtual environment.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
foreign=(test_coxeter.py test_libpysal.py test_metpy.py test_openpnm.py test_scipy_suite.py
  test_skimage.py test_trimesh.py)
# Of packages that `make test` does not install.
later=(test_clusters.py test_command_line.py test_dask.py test_maps.py test_recipes.py
  test_vectors.py)
kind_of() { # FILE
  local name
  for name in "${foreign[@]}"; do [[ ${1##*/} != "$name" ]] || { echo foreign; return; }; done
  for name in "${later[@]}"; do [[ ${1##*/} != "$name" ]] || { echo later; return; }; done
  echo short
}
if [[ ${1-} = --short-files ]]; then
  for file in "$here"/test_*.py; do
    if [[ $(kind_of "$file") = short ]]; then echo "${file##*/}"; fi
  done
  exit
fi
folder=$(realpath -m "${1:?usage: run.sh FOLDER [--install | --extras | --part short|own|foreign | PYTEST ARGUMENTS...]}")
shift
installs=no extends=no files=() options=()
case ${1:-} in
  --install)
    installs=yes
    rm -f "$folder/installed" "$folder/passed"
    ;;
  --extras) extends=yes ;;
  --part)
    for file in "$here"/test_*.py; do
      kind=$(kind_of "$file")
      [[ $kind != "$2" && ($2 != own || $kind = foreign) ]] || files+=("$file")
    done
    if [[ ${#files[@]} -eq 0 ]]; then
      echo "run.sh: there is no part $2" >&2
      exit 2
    fi
    if [[ $2 = short ]]; then options=(--note-passed "$folder/passed"); fi
    if [[ $2 = own && -e $folder/passed ]]; then options=(--leave-out "$folder/passed"); fi
    shift 2
    ;;
  *)
    installs=yes extends=yes
    files=("$here")
    ;;
esac
if [[ $installs = yes ]]; then
  export PIP_COMPILE=0 # Python compiles what is imported, a small part of what is installed
  "$here/../../../scripts/python-venv.sh" "$folder" test
  touch "$folder/installed"
elif [[ ! -f $folder/installed ]]; then
  echo "run.sh: the package is not installed in $folder" >&2
  exit 77
fi
if [[ ${1:-} = --install ]]; then exit; fi
run() {
  cd "$folder" # where nothing but the installed package is called cullhull
  exec "$folder/venv/bin/python" -m pytest -q -p no:cacheprovider "$@" "${options[@]}" "${files[@]}"
}
if [[ ${options[0]-} = --note-passed ]]; then run "$@"; fi

# Extras of whose parts PyPI may lack one or the other: without it, its tests say so and are skipped.
# Other projects' own tests are those of one version.
coxeter=0.11.0
openpnm=3.6.4
metpy=1.7.1
libpysal=4.14.1
pyvista=0.49.1
extras=(mypy pandas pyarrow shapely geopandas polars xarray scikit-image rtree hypothesis miniball "coxeter==$coxeter"
  docrep numba pint pooch pyamg pyproj rich traitlets transforms3d
  "dask[array,dataframe,distributed]" duckdb ray h5py laspy lazrs zarr pye57 pyogrio fsspec
  scikit-learn pypcd4 netCDF4 "libpysal==$libpysal" jax warp-lang)
if command -v mpirun >/dev/null; then extras+=(mpi4py); fi
if command -v java >/dev/null; then extras+=(pyspark); fi
if [[ $extends = no ]]; then extras=(); fi
# uv takes all at once, in a quarter of the time that pip takes for one after the other. It refuses all
# where one is missing: then pip takes those that are there.
if [[ ${#extras[@]} -gt 0 && ! -e $folder/extras ]]; then
  certificates=${SSL_CERT_FILE:-${PIP_CERT:-}}
  requirements=$here/../../../docs/requirements.txt # the site's, which needs no environment of its own
  if "$folder/venv/bin/pip" install --quiet --disable-pip-version-check uv &&
    env ${certificates:+"SSL_CERT_FILE=$certificates"} ${PIP_INDEX_URL:+"UV_DEFAULT_INDEX=$PIP_INDEX_URL"} \
      "$folder/venv/bin/uv" pip install --quiet --no-cache --python "$folder/venv/bin/python" \
      "${extras[@]}" -r "$requirements"; then
    cp "$requirements" "$folder/venv/requirements.txt" # scripts/docs-venv.sh asks for it
    touch "$folder/extras"
  fi
fi
for extra in "${extras[@]}"; do
  name=${extra%%[\[=]*}
  "$folder/venv/bin/python" -c "import importlib.metadata as m; m.version('$name')" 2>/dev/null ||
    "$folder/venv/bin/pip" install --quiet --disable-pip-version-check --prefer-binary "$extra" ||
    echo "run.sh: PyPI has not given $extra; its tests are left out" >&2
done

# These two need the ones above alone for what is tested; OpenPNM asks for a gigabyte of MKL.
extras=("openpnm==$openpnm" "metpy==$metpy")
if [[ $extends = no ]]; then extras=(); fi
for extra in "${extras[@]}"; do
  "$folder/venv/bin/python" -c "import importlib.metadata as m; m.version('${extra%%=*}')" 2>/dev/null ||
    "$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps "$extra" ||
    echo "run.sh: PyPI has not given $extra; its tests are left out" >&2
done

# Other projects' own tests are in their source archives alone, but for libpysal's.
fetch() { # PROJECT VERSION: prints the folder of its tests
  local archive=$folder/$1-$2
  if [[ ! -d $archive && $extends = yes ]]; then
    mkdir -p "$folder/download"
    "$folder/venv/bin/pip" download --quiet --disable-pip-version-check --no-deps \
      --no-binary "$1" --dest "$folder/download" "$1==$2" >&2 &&
      tar -xzf "$folder/download/$1-$2.tar.gz" -C "$folder" || true
  fi
  if [[ -d $archive/tests ]]; then
    echo "$archive/tests"
  else
    echo "run.sh: $1's source archive is out of reach; its own tests are left out" >&2
  fi
}
trimesh=$("$folder/venv/bin/python" -c 'import trimesh; print(trimesh.__version__)')
CULLHULL_TRIMESH_TESTS=$(fetch trimesh "$trimesh")
CULLHULL_COXETER_TESTS=$(fetch coxeter "$coxeter")
CULLHULL_OPENPNM_TESTS=$(fetch openpnm "$openpnm")
CULLHULL_METPY_TESTS=$(fetch metpy "$metpy")
export CULLHULL_TRIMESH_TESTS CULLHULL_COXETER_TESTS CULLHULL_OPENPNM_TESTS CULLHULL_METPY_TESTS

# PyVista's example meshes are in its wheel; the package itself asks for a hundred megabytes of VTK.
examples=$folder/pyvista-$pyvista/pyvista/examples
if [[ ! -d $examples && $extends = yes ]]; then
  "$folder/venv/bin/pip" download --quiet --disable-pip-version-check --no-deps \
    --only-binary :all: --dest "$folder/download" "pyvista==$pyvista" >&2 &&
    "$folder/venv/bin/python" -m zipfile -e "$folder/download/pyvista-$pyvista"-*.whl \
      "$folder/pyvista-$pyvista" ||
    echo "run.sh: PyPI has not given pyvista; its meshes are left out" >&2
fi
if [[ -d $examples ]]; then export CULLHULL_PYVISTA_EXAMPLES=$examples; fi

# scikit-image's too. pip would build it to learn its name; without the build's tools in reach it
# stops once the archive is unpacked, which is all that is wanted.
if version=$("$folder/venv/bin/python" -c 'import skimage; print(skimage.__version__)' 2>/dev/null); then
  archive=$folder/scikit-image-$version
  if [[ ! -d $archive && $extends = yes ]]; then
    mkdir -p "$folder/download/unpacked"
    TMPDIR=$folder/download/unpacked "$folder/venv/bin/pip" download --quiet \
      --disable-pip-version-check --no-clean --no-build-isolation --no-deps \
      --no-binary scikit-image --dest "$folder/download" "scikit-image==$version" 2>/dev/null || true
    mv "$folder"/download/unpacked/pip-download-*/scikit-image_* "$archive" 2>/dev/null ||
      echo "run.sh: scikit-image's source archive is out of reach; its own tests are left out" >&2
    rm -rf "$folder/download/unpacked"
  fi
  tests=$(find "$archive" -name test_convex_hull.py -path '*morphology*' 2>/dev/null | head -n 1) || true
  if [[ -n $tests ]]; then export CULLHULL_SKIMAGE_TESTS=$tests; fi
fi
if [[ ${1:-} = --extras ]]; then exit; fi
run "$@"
