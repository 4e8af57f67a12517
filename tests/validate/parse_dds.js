// How parse-dds, a reader of DDS that we did not write, finds the images of files with floats.
// node parse_dds.js NODE_MODULES FILE...   prints [{shape, format, cubemap, images: [{offset, length, shape}, ...]}, ...]
const fs = require('fs');
const path = require('path');

const [nodeModules, ...files] = process.argv.slice(2);
const parse = require(path.join(path.resolve(nodeModules), 'parse-dds'));
const results = files.map((name) => {
  const bytes = fs.readFileSync(name);
  return parse(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
});
console.log(JSON.stringify(results));
