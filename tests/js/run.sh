#!/usr/bin/env bash
# run.sh PROGRAMS: builds the npm package, tests it and runs the sample of its page. 77: not possible.
set -euo pipefail
cd "$(dirname "$0")/../.."
JOBS=2 scripts/wasm.sh js
node --expose-gc tests/js/package_test.mjs build/wasm/js "$1"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/node_modules" && ln -s "$PWD/build/wasm/js" "$folder/node_modules/cullhull"
python3 - "$folder" <<'PY'
import subprocess, sys
sys.path.insert(0, "tests/docs")
import samples
for block in samples.blocks(samples.ROOT / "docs/how-to/languages.md"):
    if block.language == "js":
        with open(sys.argv[1] + "/a.mjs", "w") as file:
            file.write(block.text)
        done = subprocess.run(["node", "a.mjs"], cwd=sys.argv[1], capture_output=True, text=True)
        if not samples.matches(block.output, done.stdout):
            sys.exit(f"{block.page}:{block.line}: {done.stdout}{done.stderr}")
        sys.exit()
sys.exit("no sample of JavaScript")
PY
