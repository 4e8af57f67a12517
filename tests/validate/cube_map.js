// How three.js, a program that we did not write, shows our KTX 2.0 cube maps on a mirroring sphere.
// node cube_map.js NODE_MODULES KTX2... < views.json
//   takes [{name, levels: [...], position: [x, y, z], size}, ...], prints for each the mirrored directions of the
//   sphere's pixels and what was seen there at each level: [{directions: [[x, y, z], ...], seen: [[[r, g, b], ...], ...]}, ...]
const fs = require('fs');
const path = require('path');
const { inBrowser } = require('./in_browser.js');

const [nodeModules, ...files] = process.argv.slice(2);
inBrowser({
  nodeModules,
  page: 'cube_map.html',
  input: { views: JSON.parse(fs.readFileSync(0, 'utf8')) },
  files: Object.fromEntries(files.map((file) => [path.basename(file), file])),
}).then(
  (result) => console.log(JSON.stringify(result)),
  (error) => {
    console.error(String(error));
    process.exitCode = 1;
  },
);
