// What our GLSL gives on WebGL 2 for reflection maps, in the browser.
// node map_shader.js SHADER.glsl < input.json
//   takes {define, uniforms: {NAME: [[x, y, ...], ...]}, texture: {name, width, height, depth, pixels: [r, g, b, ...]},
//          call: 'shellLookup', directions: [[x, y, z], ...], parameters: [...]}; depth 0 = 2D; channels 4 = RGBA as it is, not filtered
//   prints [[r, g, b], ...]
const fs = require('fs');
const { inBrowser } = require('./in_browser.js');

const input = JSON.parse(fs.readFileSync(0, 'utf8'));
input.shader = fs.readFileSync(process.argv[2], 'utf8');
inBrowser({ page: 'map_shader.html', input }).then(
  (result) => console.log(JSON.stringify(result)),
  (error) => {
    console.error(String(error));
    process.exitCode = 1;
  },
);
