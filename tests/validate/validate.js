// Runs Khronos' glTF validator on files and prints its report of each as one JSON array.
// node validate.js NODE_MODULES FILE...
const fs = require('fs');
const path = require('path');
const validator = require(path.join(process.argv[2], 'gltf-validator'));

async function main() {
  const reports = [];
  for (const file of process.argv.slice(3)) {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
      uri: path.basename(file),
      maxIssues: 50,
      externalResourceFunction: (uri) =>
        Promise.resolve(new Uint8Array(fs.readFileSync(path.join(path.dirname(file), decodeURIComponent(uri))))),
    });
    reports.push(report);
  }
  console.log(JSON.stringify(reports));
}

main().catch((error) => {
  console.error(String(error));
  process.exit(1);
});
