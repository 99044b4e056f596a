// Runs the program, compiled to WebAssembly (scripts/wasm.sh), on files of the user's: one worker for
// each run, which can be ended at any time. The page that `cullhull view` writes is shown in a frame
// without an origin. Nothing leaves the browser: the policy below allows one request, the module's.
"use strict";

const at = name => document.getElementById(name);
const wasm = new URL("cullhull.wasm", location).href;
const most = 256 << 20;  // bytes of files: what a module of 4 GiB surely holds

const policy = document.createElement("meta");
policy.httpEquiv = "Content-Security-Policy";
policy.content = `connect-src ${wasm}`;
document.head.append(policy);

// The worker's text. A worker of a blob has this page's policy, one of a file has none.
function work() {
  onmessage = async ({data: {module, files, words, output}}) => {
    const said = [];
    try {
      const program = await cullhull({
        instantiateWasm: (imports, ready) => {
          WebAssembly.instantiate(module, imports).then(ready);
          return {};
        },
        quit: (status, thrown) => { throw thrown; },
        stdin: () => null,
        stdout: () => {},
        stderr: byte => said.push(byte),
      });
      for (const file of files)
        program.FS.writeFile(file.name, new Uint8Array(await file.arrayBuffer()), {canOwn: true});
      const status = program.callMain(words);
      const bytes = status ? null : program.FS.readFile(output);
      const line = new TextDecoder().decode(new Uint8Array(said)).trim();
      postMessage({line, bytes}, bytes ? [bytes.buffer] : []);
    } catch (error) {
      const memory = error instanceof RangeError || error.name === "NotReadableError";
      postMessage({line: "cullhull: " + (memory ? "not enough memory" : error.message || error)});
    }
  };
}

let files = [], module = null, worker = null, runs = 0;

function finish(line) {
  worker?.terminate();
  worker = null;
  ++runs;
  at("cancel").disabled = true;
  at("again").disabled = at("save").disabled = files.length === 0;
  at("line").textContent = line;
}

// Runs `command` on the files; `then` gets the bytes of `output`, and returns a line.
async function run(command, output, then) {
  finish("");
  if (files.reduce((sum, file) => sum + file.size, 0) > most)
    return finish(`cullhull: more than ${most >> 20} MiB; the program itself has no such limit`);
  at("cancel").disabled = false;
  at("again").disabled = at("save").disabled = true;
  at("line").textContent = "Working ...";
  const mine = runs;
  try {
    module ??= await WebAssembly.compile(await (await fetch(wasm)).arrayBuffer());
  } catch (error) {
    return finish(`No module to run here (${error.message}): make docs builds it where emscripten is, ` +
                  "and it needs a web server");
  }
  if (mine !== runs) return;  // cancelled meanwhile
  const text = `importScripts(${JSON.stringify(new URL("cullhull.js", location).href)}); (${work})();`;
  worker = new Worker(URL.createObjectURL(new Blob([text], {type: "text/javascript"})));
  worker.onerror = event => finish("cullhull: " + event.message);
  worker.onmessage = ({data}) => finish(data.bytes ? then(data.bytes) : data.line);
  const words = files.map(file => "./" + file.name);
  const options = at("options").value.split(/\s+/).filter(word => word);
  worker.postMessage({module, files, words: [...command, ...words, ...options, "-o", output], output});
}

function show() {
  at("page").srcdoc = "";
  const began = performance.now();
  run(["view", "-q", ...[at("cells").value].filter(word => word)], "page.html", bytes => {
    at("page").srcdoc = new TextDecoder().decode(bytes);
    return `${files.map(file => file.name).join(", ")}: ${((performance.now() - began) / 1000).toFixed(1)} s`;
  });
}

function save() {
  const name = at("save").value;
  at("save").selectedIndex = 0;
  run([name.split(".")[0], "-q"], name, bytes => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([bytes]));
    link.download = name;
    link.click();
    URL.revokeObjectURL(link.href);
    return `saved ${name}, ${bytes.length} bytes`;
  });
}

function take(list) {
  files = [...list];
  if (files.length > 0) show();
}

at("files").onchange = event => take(event.target.files);
at("cells").onchange = at("again").onclick = () => take(files);
at("form").onsubmit = event => { event.preventDefault(); take(files); };
at("save").onchange = save;
at("cancel").onclick = () => finish("cancelled");
ondragover = event => { event.preventDefault(); at("drop").classList.add("over"); };
ondragleave = () => at("drop").classList.remove("over");
ondrop = event => {
  event.preventDefault();
  at("drop").classList.remove("over");
  take(event.dataTransfer.files);
};
