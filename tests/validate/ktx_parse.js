// How ktx-parse, a reader of KTX 2.0 that we did not write (three.js brings it along), reads files.
// node ktx_parse.js NODE_MODULES FILE...   prints [{everything it found; level data as base64}, ...]
const fs = require('fs');
const path = require('path');
const { pathToFileURL } = require('url');

const [nodeModules, ...files] = process.argv.slice(2);

async function main() {
  const file = path.join(nodeModules, 'three/examples/jsm/libs/ktx-parse.module.js');
  const { read } = await import(pathToFileURL(file));
  return files.map((name) => {
    const container = read(new Uint8Array(fs.readFileSync(name)));
    for (const level of container.levels) level.levelData = Buffer.from(level.levelData).toString('base64');
    return container;
  });
}

main().then(
  (result) => console.log(JSON.stringify(result)),
  (error) => {
    console.error(String(error));
    process.exitCode = 1;
  },
);
