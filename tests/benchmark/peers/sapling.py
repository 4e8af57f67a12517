"""Times Blender's add-on Sapling Tree Gen, for `kokage bench trees`:

    blender --background --factory-startup --python sapling.py -- MOST_LEAVES PRESET...

One line of JSON a tree: {species, leaves, triangles, cpu_seconds, bytes}. The time is that of the add-on's operator and of
turning its curves into a mesh, which they become when they are exported or drawn.
"""
import ast
import json
import os
import sys
import time

import numpy

numpy.bool = bool  # Blender 3.4 in Debian 12 reads a name that numpy 1.24 has dropped

import addon_utils
import bpy

addon_utils.enable("add_curve_sapling")
import add_curve_sapling

VERTICES_OF_A_LEAF = {"hex": 6, "rect": 4}
BYTES_OF_A_VERTEX = 12 + 12 + 8  # position, normal, texture coordinate
BYTES_OF_A_TRIANGLE = 12


def preset(name):
    path = os.path.join(os.path.dirname(add_curve_sapling.__file__), "presets", name + ".py")
    with open(path) as file:
        values = ast.literal_eval([line for line in file if line.startswith("{")][0])
    known = bpy.ops.curve.tree_add.get_rna_type().properties.keys()
    return {key: value for key, value in values.items() if key in known}


def grow(arguments):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon_utils.enable("add_curve_sapling")
    start = time.process_time()
    bpy.ops.curve.tree_add(**arguments)
    graph = bpy.context.evaluated_depsgraph_get()
    tree = bpy.data.objects["tree"].evaluated_get(graph).to_mesh()
    seconds = time.process_time() - start
    leaves = bpy.data.objects["leaves"].data
    vertices = len(tree.vertices) + len(leaves.vertices)
    triangles = sum(len(polygon.vertices) - 2 for mesh in (tree, leaves) for polygon in mesh.polygons)
    return {
        "leaves": len(leaves.vertices) // VERTICES_OF_A_LEAF[arguments["leafShape"]],
        "triangles": triangles,
        "cpu_seconds": seconds,
        "bytes": vertices * BYTES_OF_A_VERTEX + triangles * BYTES_OF_A_TRIANGLE,
    }


most_leaves, *names = sys.argv[sys.argv.index("--") + 1:]
for name in names:
    arguments = preset(name)
    arguments.update(do_update=True, showLeaves=True)
    as_designed = arguments["leaves"]
    factor = 1
    while True:
        arguments["leaves"] = as_designed * factor
        record = grow(arguments)
        if factor > 1 and record["leaves"] > int(most_leaves):
            break
        print(json.dumps({"species": name, **record}), flush=True)
        factor *= 4
