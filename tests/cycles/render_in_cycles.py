"""Renders a scene in Blender's Cycles (3.4), for the cross-check of our path tracer (cycles_picture.h):

    blender --background --factory-startup --python-exit-code 1 --python render_in_cycles.py -- FOLDER

FOLDER holds scene.json and what it names: raw arrays of little-endian float32 and uint32, images as EXR. For each seed one
picture is written there: linear, colour multiplied by alpha, surroundings left out.

Axes: ours are right-handed with +Y up, Blender's right-handed with +Z up, so (x, y, z) becomes (x, -z, y). Lat-long images need no
turning: Blender's u = 0.5 - atan2(Y, X) / 2 pi is our 0.5 + atan2(z, x) / 2 pi.

What would differ from our model unless told otherwise, and is set here: number of bounces and of transparent surfaces (limited),
clamping of indirect light (on), blurred gloss (on), light below a threshold (dropped), adaptive sampling and denoising (on), the
display's colours (pictures are saved scene-linear, textures are read as data), and the offset by which smooth surfaces are lit
(shadow terminator).
"""
import json
import math
import os
import sys

import numpy

numpy.bool = bool  # Blender 3.4 in Debian 12 reads a name that numpy 1.24 has dropped

import bpy
from mathutils import Matrix, Vector

folder = sys.argv[sys.argv.index("--") + 1]
with open(os.path.join(folder, "scene.json")) as file:
    description = json.load(file)

MOST_BOUNCES = 1024  # Blender's limit; paths of such length carry nothing


def turned(vectors):
    """From +Y up to +Z up."""
    return numpy.ascontiguousarray(numpy.stack([vectors[..., 0], -vectors[..., 2], vectors[..., 1]], axis=-1))


def array(name, kind, columns):
    return numpy.fromfile(os.path.join(folder, name), dtype=kind).reshape(-1, columns)


def image_node(nodes, name, interpolation, extension):
    node = nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.load(os.path.join(folder, name))
    node.image.colorspace_settings.name = "Non-Color"
    node.interpolation = interpolation
    node.extension = extension
    return node


def colour(nodes, links, value, factor):
    """A constant colour, times a texture where there is one."""
    constant = nodes.new("ShaderNodeRGB")
    constant.outputs[0].default_value = (*value, 1)
    if factor is None:
        return constant.outputs[0]
    product = nodes.new("ShaderNodeMixRGB")
    product.blend_type = "MULTIPLY"
    product.inputs[0].default_value = 1
    links.new(constant.outputs[0], product.inputs[1])
    links.new(factor, product.inputs[2])
    return product.outputs[0]


def make_material(index, values):
    """Two-sided Lambertian: diffuse reflection and diffuse transmission (Blender's "translucent") summed; holes where the mask is 0."""
    material = bpy.data.materials.new(f"material {index}")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    factor = None
    if "texture" in values:
        factor = image_node(nodes, values["texture"], "Linear", values["extension"]).outputs["Color"]
    diffuse, translucent = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeBsdfTranslucent")
    links.new(colour(nodes, links, values["reflectance"], factor), diffuse.inputs["Color"])
    links.new(colour(nodes, links, values["transmittance"], factor), translucent.inputs["Color"])
    surface = nodes.new("ShaderNodeAddShader")
    links.new(diffuse.outputs[0], surface.inputs[0])
    links.new(translucent.outputs[0], surface.inputs[1])
    if "mask" in values:
        solid = nodes.new("ShaderNodeMixShader")
        links.new(image_node(nodes, values["mask"], "Closest", values["mask_extension"]).outputs["Color"], solid.inputs[0])
        links.new(nodes.new("ShaderNodeBsdfTransparent").outputs[0], solid.inputs[1])
        links.new(surface.outputs[0], solid.inputs[2])
        surface = solid
    links.new(surface.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material


def add_mesh(name, positions, triangles, materials):
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", positions.ravel())
    mesh.loops.add(3 * len(triangles))
    mesh.loops.foreach_set("vertex_index", triangles.ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", numpy.arange(0, 3 * len(triangles), 3, dtype=numpy.int32))
    mesh.polygons.foreach_set("loop_total", numpy.full(len(triangles), 3, dtype=numpy.int32))
    for material in materials:
        mesh.materials.append(material)
    mesh.update(calc_edges=True)
    body = bpy.data.objects.new(name, mesh)
    body.cycles.shadow_terminator_geometry_offset = 0
    body.cycles.shadow_terminator_offset = 0
    bpy.context.scene.collection.objects.link(body)
    return body


def add_surfaces(values):
    """Flat and smooth triangles as a body each: giving normals to some of a mesh would smooth all of it."""
    positions, normals = (turned(array(name, numpy.float32, 3)) for name in ("positions.f32", "normals.f32"))
    triangles = array("triangles.u32", numpy.uint32, 3).astype(numpy.int32)
    uvs = array("uvs.f32", numpy.float32, 2)
    indices = array("triangle_material.u32", numpy.uint32, 1).astype(numpy.int32).ravel()
    smooth = array("triangle_smooth.u32", numpy.uint32, 1).ravel() != 0
    materials = [make_material(index, material) for index, material in enumerate(values["materials"])]
    for chosen in (~smooth, smooth):
        if not chosen.any():
            continue
        corners = triangles[chosen].ravel()
        used, corners = numpy.unique(corners, return_inverse=True)
        mesh = add_mesh("surfaces", positions[used], corners.astype(numpy.int32).reshape(-1, 3), materials).data
        mesh.polygons.foreach_set("material_index", indices[chosen])
        mesh.polygons.foreach_set("use_smooth", smooth[chosen])
        if len(uvs):
            of_corners = uvs[used][corners]
            of_corners[:, 1] = 1 - of_corners[:, 1]  # Blender counts from the bottom row
            mesh.uv_layers.new(name="uv").data.foreach_set("uv", of_corners.ravel())
        if smooth[chosen].any():
            mesh.use_auto_smooth = True
            mesh.auto_smooth_angle = math.pi
            mesh.normals_split_custom_set_from_vertices(normals[used])


def add_ground(values):
    edge, height = values["half_edge"], values["height"]
    corners = numpy.array([[-edge, -edge, height], [edge, -edge, height], [edge, edge, height], [-edge, edge, height]], dtype=numpy.float32)
    ground = add_mesh("ground", corners, numpy.array([[0, 1, 2], [0, 2, 3]], dtype=numpy.int32),
                      [make_material("ground", {"reflectance": values["albedo"], "transmittance": [0, 0, 0]})])
    ground.visible_camera = False  # it lights and shadows; the cross-check looks at surfaces


def add_world(image):
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    nodes.clear()
    environment = nodes.new("ShaderNodeTexEnvironment")
    environment.image = bpy.data.images.load(os.path.join(folder, image))
    environment.image.colorspace_settings.name = "Non-Color"
    environment.interpolation = "Linear"
    background = nodes.new("ShaderNodeBackground")
    links.new(environment.outputs[0], background.inputs[0])
    links.new(background.outputs[0], nodes.new("ShaderNodeOutputWorld").inputs["Surface"])
    world.cycles.sampling_method = "MANUAL"
    world.cycles.sample_map_resolution = 2048
    world.light_settings.use_ambient_occlusion = False


def add_sun(values):
    light = bpy.data.lights.new("sun", "SUN")
    light.energy = 1
    light.color = values["irradiance"]
    light.angle = 2 * values["half_angle"]
    light.cycles.use_multiple_importance_sampling = True
    body = bpy.data.objects.new("sun", light)
    # A lamp shines along its -Z: its +Z points to the sun.
    towards = Vector(turned(numpy.array(values["direction"], dtype=float)))
    body.rotation_euler = towards.to_track_quat("Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(body)


def add_camera(values):
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "VERTICAL"
    camera.sensor_height = 24
    camera.lens = 12 / math.tan(values["vertical_field_of_view"] / 2)
    camera.clip_start, camera.clip_end = 1e-3, 1e5
    body = bpy.data.objects.new("camera", camera)
    right, up, forward, place = (turned(numpy.array(values[key], dtype=float)) for key in ("right", "up", "forward", "position"))
    body.matrix_world = Matrix([[right[i], up[i], -forward[i], place[i]] for i in range(3)] + [[0, 0, 0, 1]])
    bpy.context.scene.collection.objects.link(body)
    bpy.context.scene.camera = body


def prepare(scene, values):
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = values["samples"]
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    for name in ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces", "transparent_max_bounces"):
        setattr(cycles, name, MOST_BOUNCES)
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.blur_glossy = 0
    cycles.light_sampling_threshold = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    # The same window as ours: Blackman-Harris, 3 pixels in all.
    cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    cycles.filter_width = 1.5
    scene.render.film_transparent = True
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = values["width"], values["height"], 100
    scene.render.threads_mode, scene.render.threads = "FIXED", values["threads"]
    scene.render.use_motion_blur = False
    scene.view_settings.view_transform = "Raw"
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth, settings.exr_codec = "OPEN_EXR", "RGBA", "32", "ZIP"


bpy.ops.wm.read_factory_settings(use_empty=True)
add_surfaces(description)
if "ground" in description:
    add_ground(description["ground"])
add_world(description["environment"])
for sun in description["suns"]:
    add_sun(sun)
add_camera(description["camera"])
prepare(bpy.context.scene, description)
for seed, picture in enumerate(description["pictures"]):
    bpy.context.scene.cycles.seed = seed
    bpy.context.scene.render.filepath = os.path.join(folder, picture)
    bpy.ops.render.render(write_still=True)
