// A scene file's materials.
#include "viewer/scene/scene_parts.h"

namespace kokage {
namespace {

std::filesystem::path find_picture(const JsonReader& name, const SceneFiles& files) {
    return files.find(name, {".png", ".jpg", ".jpeg", ".exr", ".hdr", ".tif", ".tiff", ".tga", ".bmp", ".webp"});
}

ReliefDescription read_relief(const JsonReader& json, const SceneFiles& files) {
    ReliefDescription relief;
    if (json.is_boolean()) {
        if (json.boolean())
            json.fail("found true where false (none) or an object { } is needed; { } is the bark's own relief");
        relief.none = true;
        return relief;
    }
    json.check_keys({"heights", "normals", "depth", "repeat", "scale"});
    const auto heights = json.find("heights"), normals = json.find("normals"), depth = json.find("depth"),
               repeat = json.find("repeat"), scale = json.find("scale");
    if (heights && normals)
        json.fail("'heights' and 'normals' contradict one another; keep one of them");
    for (const char* key : {"heights", "normals", "depth"})
        if (scale && json.find(key))
            scale->fail("'scale' makes the bark's own relief deeper or shallower, and '" + std::string(key) +
                        "' takes its place; keep one of them");
    if (heights) {
        relief.heights = find_picture(*heights, files);
        if (!depth)
            json.fail("'heights' needs 'depth', the metres from its white to its black");
    }
    if (normals) {
        relief.normals = find_picture(*normals, files);
        if (!depth && !repeat)
            json.fail("'normals' needs 'depth' (metres from the highest to the lowest), or 'repeat' (a tile's width in "
                      "metres), to give its heights a scale");
    }
    if (repeat && !normals)
        repeat->fail("'repeat' gives 'normals' a scale, which are not there; give 'depth'");
    if (repeat && depth)
        repeat->fail("'repeat' and 'depth' contradict one another; keep one of them");
    if (depth)
        relief.depth_m = depth->number(1e-6, 10);
    if (scale)
        relief.scale = scale->number(0.01, 100);
    if (repeat)
        relief.repeat_m = repeat->number(1e-4, 1e4);
    return relief;
}

} // namespace

MaterialDescription read_material(const JsonReader& json, const SceneFiles& files) {
    json.check_keys({"base_color", "base_color_texture", "roughness", "roughness_texture", "roughness_from_foot_to_top",
                     "metallic", "index_of_refraction", "relief"});
    MaterialDescription material;
    material.pointer = json.pointer();
    if (const auto color = json.find("base_color"))
        material.base_color = color->color();
    if (const auto texture = json.find("base_color_texture"))
        material.base_color_texture = find_picture(*texture, files);
    if (const auto roughness = json.find("roughness"))
        material.roughness = roughness->number(0, 1);
    if (const auto texture = json.find("roughness_texture"))
        material.roughness_texture = find_picture(*texture, files);
    if (const auto range = json.find("roughness_from_foot_to_top")) {
        for (const char* other : {"roughness", "roughness_texture"})
            if (json.find(other))
                range->fail("'roughness_from_foot_to_top' and '" + std::string(other) +
                            "' contradict one another; keep one of them");
        const std::vector<JsonReader> ends = range->elements(2, 2);
        material.roughness_from_foot_to_top = {ends[0].number(0, 1), ends[1].number(0, 1)};
    }
    if (const auto metallic = json.find("metallic"))
        material.metallic = metallic->number(0, 1);
    if (const auto index = json.find("index_of_refraction"))
        material.index_of_refraction = index->number(1, 5);
    if (const auto relief = json.find("relief"))
        material.relief = read_relief(*relief, files);
    return material;
}

} // namespace kokage
