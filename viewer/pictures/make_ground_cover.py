#!/usr/bin/env python3
"""Makes what lies and grows on the ground of the gallery's scenes: scenes/meadow.glb, fallen_leaves.glb, path.obj and backdrop.obj.

    viewer/pictures/make_ground_cover.py

Needs Python alone. The files are kept with the scenes, so that drawing these needs no Python; this is how they were made.
One leaf each of a few colours, repeated by EXT_mesh_gpu_instancing. Metres, Y up.
"""
import json
import math
import pathlib
import random
import struct

FLOAT, SHORT, UNSIGNED_SHORT = 5126, 5122, 5123


class Glb:
    """A scene of a few meshes, each drawn many times."""

    def __init__(self):
        self.binary = bytearray()
        self.json = {
            "asset": {"version": "2.0", "generator": "make_ground_cover.py"},
            "extensionsUsed": ["EXT_mesh_gpu_instancing", "KHR_materials_diffuse_transmission"],
            "extensionsRequired": ["EXT_mesh_gpu_instancing"],
            "scene": 0,
            "scenes": [{"nodes": []}],
            "nodes": [],
            "meshes": [],
            "materials": [],
            "accessors": [],
            "bufferViews": [],
        }

    def _add(self, name, entry):
        self.json[name].append(entry)
        return len(self.json[name]) - 1

    def _accessor(self, rows, kind, component, **more):
        letter = {FLOAT: "f", SHORT: "h", UNSIGNED_SHORT: "H"}[component]
        self.binary += bytes(-len(self.binary) % 4)
        start = len(self.binary)
        for row in rows:
            self.binary += struct.pack("<%d%s" % (len(row), letter), *row)
        view = self._add("bufferViews", {"buffer": 0, "byteOffset": start, "byteLength": len(self.binary) - start})
        return self._add("accessors", {"bufferView": view, "componentType": component, "type": kind, "count": len(rows), **more})

    def leaf_material(self, name, reflectance, transmittance):
        """Reflectance (1 - f) x base colour and transmittance f x transmission colour, with f = 1/2."""
        return self._add("materials", {
            "name": name,
            "doubleSided": True,
            "pbrMetallicRoughness": {"baseColorFactor": [2 * c for c in reflectance] + [1], "metallicFactor": 0, "roughnessFactor": 0.6},
            "extensions": {"KHR_materials_diffuse_transmission": {
                "diffuseTransmissionFactor": 0.5, "diffuseTransmissionColorFactor": [2 * c for c in transmittance]}},
        })

    def mesh(self, name, positions, triangles, material):
        low = [min(p[a] for p in positions) for a in range(3)]
        high = [max(p[a] for p in positions) for a in range(3)]
        position = self._accessor(positions, "VEC3", FLOAT, min=low, max=high)
        corners = self._accessor([[i] for t in triangles for i in t], "SCALAR", UNSIGNED_SHORT)
        return self._add("meshes", {"name": name, "primitives": [
            {"attributes": {"POSITION": position}, "indices": corners, "material": material}]})

    def instances(self, name, mesh, places):
        """places: (translation, rotation quaternion x y z w, scale) each."""
        translation = self._accessor([p[0] for p in places], "VEC3", FLOAT)
        rotation = self._accessor([[round(32767 * q) for q in p[1]] for p in places], "VEC4", SHORT, normalized=True)
        scale = self._accessor([[p[2]] * 3 for p in places], "VEC3", FLOAT)
        node = self._add("nodes", {"name": name, "mesh": mesh, "extensions": {"EXT_mesh_gpu_instancing": {
            "attributes": {"TRANSLATION": translation, "ROTATION": rotation, "SCALE": scale}}}})
        self.json["scenes"][0]["nodes"].append(node)

    def write(self, path):
        self.binary += bytes(-len(self.binary) % 4)
        self.json["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(self.json, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(self.binary), 0x004E4942) + self.binary
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)


def turned(axis, angle):
    s = math.sin(angle / 2)
    return [axis[0] * s, axis[1] * s, axis[2] * s, math.cos(angle / 2)]


def after(a, b):
    """The rotation b, then a."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz]


def blade():
    """A blade of grass 1 long that bends towards +X, in three pieces; bent no more than keeps it one leaf."""
    positions = []
    for t, half_width in ((0, 0.012), (0.4, 0.014), (0.75, 0.010)):
        for side in (-1, 1):
            positions.append([0.24 * t * t, t - 0.06 * t * t, side * half_width])
    positions.append([0.24, 0.94, 0])
    return positions, [[0, 1, 3], [0, 3, 2], [2, 3, 5], [2, 5, 4], [4, 5, 6]]


def maple_leaf():
    """A maple's blade 1 long with its stalk's end at the origin, lying in the XZ plane, its edges a little raised."""
    outline = [(0, 0), (0.10, -0.04), (0.30, 0.04), (0.24, 0.16), (0.50, 0.36), (0.34, 0.42), (0.36, 0.66), (0.17, 0.58), (0.10, 0.76), (0, 1)]
    outline += [(-x, z) for x, z in reversed(outline[1:-1])]
    positions = [[0, 0, 0.38]] + [[x, 0.16 * x * x + 0.05 * (z - 0.4) ** 2, z] for x, z in outline]
    count = len(outline)
    return positions, [[0, 1 + (i + 1) % count, 1 + i] for i in range(count)]


def meadow(path):
    """A round piece of meadow, dense in the middle: tufts of 8 to 20 blades within some 1.6 m."""
    rng = random.Random(1)
    glb = Glb()
    kinds = []
    for name, reflectance, transmittance in (("fresh grass", (0.055, 0.105, 0.022), (0.05, 0.11, 0.015)),
                                             ("grass", (0.075, 0.105, 0.03), (0.06, 0.10, 0.02)),
                                             ("dry grass", (0.17, 0.15, 0.075), (0.10, 0.09, 0.04))):
        kinds.append((name, glb.mesh(name, *blade(), glb.leaf_material(name, reflectance, transmittance)), []))
    for _ in range(230):
        x, z = rng.gauss(0, 0.8), rng.gauss(0, 0.8)
        height, spread, kind = rng.lognormvariate(math.log(0.16), 0.35), rng.uniform(0.015, 0.05), rng.choices((0, 1, 2), (5, 4, 1))[0]
        for _ in range(rng.randint(8, 20)):
            away = rng.uniform(-math.pi, math.pi)
            lean = abs(rng.gauss(0.25, 0.25))
            out = spread * math.sqrt(rng.random())
            rotation = after(turned((0, 1, 0), -away), turned((0, 0, 1), -lean))
            place = (x + out * math.cos(away), -0.005, z + out * math.sin(away))
            kinds[kind][2].append((place, rotation, height * rng.uniform(0.6, 1.15)))
    for kind in kinds:
        glb.instances(*kind)
    glb.write(path)


def fallen_leaves(path):
    """A maple's leaves of autumn around the origin, within some 3 m."""
    rng = random.Random(2)
    glb = Glb()
    kinds = []
    for name, reflectance, transmittance in (("red leaf", (0.22, 0.03, 0.015), (0.16, 0.015, 0.005)),
                                             ("orange leaf", (0.30, 0.10, 0.02), (0.24, 0.07, 0.01)),
                                             ("yellow leaf", (0.34, 0.22, 0.04), (0.28, 0.17, 0.02)),
                                             ("brown leaf", (0.15, 0.085, 0.045), (0.06, 0.03, 0.015))):
        kinds.append((name, glb.mesh(name, *maple_leaf(), glb.leaf_material(name, reflectance, transmittance)), []))
    for _ in range(420):
        x, z = rng.gauss(0, 1.5), rng.gauss(0, 1.5)
        size = rng.uniform(0.075, 0.13)
        tilt = min(0.5, abs(rng.gauss(0, 0.16)))
        rotation = after(turned((1, 0, 0), tilt), turned((0, 1, 0), rng.uniform(-math.pi, math.pi)))
        on_face = rng.random() < 0.4
        if on_face:
            rotation = after(rotation, turned((0, 0, 1), math.pi))
        kinds[rng.choices((0, 1, 2, 3), (4, 4, 2, 2))[0]][2].append(((x, 0.004 + 0.04 * size * on_face + 0.8 * size * math.sin(tilt), z), rotation, size))
    for kind in kinds:
        glb.instances(*kind)
    glb.write(path)


def path_of_gravel(path):
    """A strip along Z, some 2.4 m wide, 90 m long, a little above the ground, with edges as feet and rain leave them."""
    rng = random.Random(3)
    left = right = 0.0
    lines, rows = ["# Made by make_ground_cover.py", "o path"], 180
    for row in range(rows + 1):
        left, right = 0.7 * left + rng.gauss(0, 0.05), 0.7 * right + rng.gauss(0, 0.05)
        for x in (-1.2 + left, -0.4, 0.4, 1.2 + right):
            lines.append("v %.3f 0.004 %.3f" % (x, 45 - 0.5 * row))
    for row in range(rows):
        for column in range(3):
            a = 4 * row + column + 1
            lines.append("f %d %d %d %d" % (a, a + 1, a + 5, a + 4))
    path.write_text("\n".join(lines) + "\n")


def studio_backdrop(path):
    """A photographer's backdrop: a floor that rises in a curve into a wall, seamless, 60 m wide. The floor is at y = 0, and ends behind a camera 30 m away."""
    floor_end, bend_at, radius, top = 34.0, -6.0, 5.0, 24.0
    profile = [(z, 0.0) for z in (floor_end, 20.0, 10.0, 5.0, 0.0, -3.0)]
    for step in range(13):
        angle = 0.5 * math.pi * step / 12
        profile.append((bend_at - radius * math.sin(angle), radius * (1 - math.cos(angle))))
    profile += [(bend_at - radius, 10.0), (bend_at - radius, top)]
    columns = [-30 + 6 * column for column in range(11)]
    lines = ["# Made by make_ground_cover.py", "o backdrop"]
    for z, y in profile:
        lines += ["v %.3f %.4f %.4f" % (x, y, z) for x in columns]
    for row in range(len(profile) - 1):
        for column in range(len(columns) - 1):
            a = row * len(columns) + column + 1
            lines.append("f %d %d %d %d" % (a, a + 1, a + 1 + len(columns), a + len(columns)))
    path.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    scenes = pathlib.Path(__file__).parent / "scenes"
    meadow(scenes / "meadow.glb")
    fallen_leaves(scenes / "fallen_leaves.glb")
    path_of_gravel(scenes / "path.obj")
    studio_backdrop(scenes / "backdrop.obj")
