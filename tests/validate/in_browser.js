// Runs a page in headless Chromium (WebGL in software, by SwiftShader) and gives back what it computed.
//   await inBrowser({ nodeModules, page: 'lat_long.html', input: {...}, files: { name: path } })
// The page is served from this folder, npm packages under /node_modules/, `files` under /files/NAME, `input` as
// /input.json; it answers with `await fetch('/result', { method: 'POST', body: JSON.stringify(...) })`, or to /error.
const { spawn, spawnSync } = require('child_process');
const fs = require('fs');
const http = require('http');
const os = require('os');
const path = require('path');

const types = { '.html': 'text/html', '.js': 'text/javascript', '.json': 'application/json', '.png': 'image/png' };

/// The program's name; undefined if there is none here.
function findChromium() {
  const names = [process.env.KOKAGE_CHROMIUM, 'chromium', 'chromium-browser', 'google-chrome'].filter(Boolean);
  return names.find((name) => spawnSync(name, ['--version'], { stdio: 'ignore' }).status === 0);
}

function readBody(request) {
  return new Promise((resolve, reject) => {
    const parts = [];
    request.on('data', (part) => parts.push(part));
    request.on('end', () => resolve(Buffer.concat(parts).toString()));
    request.on('error', reject);
  });
}

function startServer({ nodeModules, input, files }, answer) {
  const place = (url) => {
    if (url.startsWith('/node_modules/')) return path.join(nodeModules, path.normalize(url.slice(13)));
    if (url.startsWith('/files/')) return files[decodeURIComponent(url.slice(7))];
    return path.join(__dirname, path.normalize(url));
  };
  const server = http.createServer(async (request, response) => {
    const url = request.url.split('?')[0];
    if (request.method === 'POST') {
      answer(url, await readBody(request));
      response.end();
    } else if (url === '/input.json') {
      response.setHeader('Content-Type', types['.json']);
      response.end(JSON.stringify(input));
    } else {
      const file = place(url);
      if (!file || !fs.existsSync(file)) {
        response.statusCode = 404;
        response.end();
        return;
      }
      response.setHeader('Content-Type', types[path.extname(file)] || 'application/octet-stream');
      fs.createReadStream(file).pipe(response);
    }
  });
  return new Promise((resolve) => server.listen(0, '127.0.0.1', () => resolve(server)));
}

async function inBrowser({ nodeModules, page, input = {}, files = {}, seconds = 120 }) {
  const chromium = findChromium();
  if (!chromium) throw new Error('there is no chromium here');
  const profile = fs.mkdtempSync(path.join(os.tmpdir(), 'kokage-chromium-'));
  let server, browser, timer;
  try {
    return await new Promise(async (resolve, reject) => {
      server = await startServer({ nodeModules, input, files }, (url, body) =>
        url === '/result' ? resolve(JSON.parse(body)) : reject(new Error(`${page}: ${body}`)),
      );
      timer = setTimeout(() => reject(new Error(`${page} did not answer within ${seconds} s`)), 1000 * seconds);
      // No sandbox: the page is ours, and root (in containers) has none.
      const options = ['--headless=new', '--no-sandbox', '--disable-dev-shm-usage', '--no-first-run', '--no-proxy-server',
        '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', `--user-data-dir=${profile}`];
      browser = spawn(chromium, [...options, `http://127.0.0.1:${server.address().port}/${page}`], {
        stdio: 'ignore',
        env: { ...process.env, TMPDIR: profile }, // what it leaves behind goes with its profile
        detached: true, // a process group of its own, so that it can be ended whole
      });
      browser.on('error', reject);
      browser.on('exit', (code) => reject(new Error(`chromium ended with ${code} before ${page} answered`)));
    });
  } finally {
    clearTimeout(timer);
    if (browser && browser.exitCode === null) {
      const ended = new Promise((resolve) => browser.once('exit', resolve));
      process.kill(-browser.pid, 'SIGKILL');
      await ended;
    }
    if (server) {
      server.closeAllConnections();
      server.close();
    }
    fs.rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
  }
}

module.exports = { findChromium, inBrowser };
