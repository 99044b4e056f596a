// program.cjs MODULE WORD...: runs the program compiled to WebAssembly as if it were this system's.
// The module gets copies of all files of the working directory, and what it changes is copied back.
"use strict";
const fs = require("fs"), path = require("path");

const printed = [], said = [];
const loader = path.resolve(process.argv[2]);
require(loader)({
  wasmBinary: fs.readFileSync(loader.replace(/js$/, "wasm")),
  quit: (status, thrown) => { throw thrown; },  // or node would end at once
  stdin: () => null,
  stdout: byte => printed.push(byte),  // by bytes: a module's print() is a terminal's
  stderr: byte => said.push(byte),
}).then(({FS, callMain}) => {
  const given = {};
  FS.mkdir("/work");
  FS.chdir("/work");
  for (const name of fs.readdirSync(".", {recursive: true}))
    if (fs.statSync(name).isDirectory()) FS.mkdirTree(name);
    else FS.writeFile(name, given[name] = fs.readFileSync(name));
  process.exitCode = callMain(process.argv.slice(3));
  fs.writeSync(1, Buffer.from(printed));
  fs.writeSync(2, Buffer.from(said));
  const copy = folder => {
    for (const name of FS.readdir("/work/" + folder).filter(name => !name.startsWith("."))) {
      const file = path.join(folder, name);
      if (FS.isDir(FS.stat("/work/" + file).mode)) {
        copy(file);
        continue;
      }
      const bytes = FS.readFile("/work/" + file);
      if (!given[file]?.equals(bytes)) fs.writeFileSync(file, bytes);
    }
  };
  copy("");
});
