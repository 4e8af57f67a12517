// Times npm's @dgreenheck/ez-tree under node, for `kokage bench trees`:
//
//     node ez_tree.mjs FOLDER_OF_NODE_MODULES MOST_LEAVES PRESET...     (such as "Oak Medium")
//
// One line of JSON a tree: {species, leaves, triangles, cpu_seconds, bytes}. Its leaves are cards, two crossed squares each.
import { createRequire } from 'node:module';
import { pathToFileURL } from 'node:url';

// Its textures load when the module does, and wait for a browser's document that never answers here.
const image = { addEventListener() {}, removeEventListener() {} };
globalThis.document = { createElementNS: () => image };

const [folder, mostLeaves, ...presets] = process.argv.slice(2);
const require = createRequire(folder + '/');
const { Tree } = await import(pathToFileURL(require.resolve('@dgreenheck/ez-tree').replace('.umd.js', '.es.js')));

function bytesOf(geometry) {
  const arrays = [...Object.values(geometry.attributes), geometry.index];
  return arrays.reduce((sum, attribute) => sum + attribute.array.byteLength, 0);
}

function cpuSeconds() {
  const { user, system } = process.cpuUsage();
  return (user + system) * 1e-6;
}

/// The median of three times, after one that lets node compile it.
function measure(tree) {
  tree.generate();
  const times = [0, 1, 2].map(() => {
    const start = cpuSeconds();
    tree.generate();
    return cpuSeconds() - start;
  });
  return times.sort((a, b) => a - b)[1];
}

for (const preset of presets) {
  const tree = new Tree();
  tree.loadPreset(preset); // an unknown name gives the default tree in silence
  const asDesigned = tree.options.leaves.count;
  for (let factor = 1; ; factor *= 4) {
    tree.options.leaves.count = asDesigned * factor;
    const seconds = measure(tree);
    const corners = tree.options.leaves.billboard === 'double' ? 8 : 4;
    const leaves = tree.leaves.verts.length / 3 / corners;
    if (factor > 1 && leaves > Number(mostLeaves)) break;
    console.log(
      JSON.stringify({
        species: preset,
        leaves,
        triangles: tree.triangleCount,
        cpu_seconds: seconds,
        bytes: bytesOf(tree.branchesMesh.geometry) + bytesOf(tree.leavesMesh.geometry),
      }),
    );
  }
}
