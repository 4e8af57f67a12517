// How three.js, a program that we did not write, reads lat-long images: of each, the radiance that it shows in given
// directions, and what a white diffuse surface reflects that faces each of them.
// node lat_long.js NODE_MODULES IMAGE... < directions.json
//   takes [[x, y, z], ...], prints [{background: [[r, g, b], ...], diffuse: [[r, g, b], ...]}, ...]
const fs = require('fs');
const path = require('path');
const { inBrowser } = require('./in_browser.js');

const [nodeModules, ...images] = process.argv.slice(2);
inBrowser({
  nodeModules,
  page: 'lat_long.html',
  input: { names: images.map((image) => path.basename(image)), directions: JSON.parse(fs.readFileSync(0, 'utf8')) },
  files: Object.fromEntries(images.map((image) => [path.basename(image), image])),
}).then(
  (result) => console.log(JSON.stringify(result)),
  (error) => {
    console.error(String(error));
    process.exitCode = 1;
  },
);
