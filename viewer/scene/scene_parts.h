#pragma once
// Parts of a scene file, each read by itself. Private to read_scene. All fail as JsonReader does.
#include "common/services/json_reader.h"
#include "viewer/scene/scene_description.h"
#include "viewer/scene/scene_files.h"

namespace kokage {

void read_environment(const JsonReader& json, const SceneFiles& files, SceneDescription& scene);
/// As text, as the command line has it.
std::string read_light(const JsonReader& json);
void read_ground(const JsonReader& json, Surroundings& surroundings);

MaterialDescription read_material(const JsonReader& json, const SceneFiles& files);

PlacedTree read_placed_tree(const JsonReader& json, const SceneFiles& files);
PlacedObject read_placed_object(const JsonReader& json, const SceneFiles& files);

CameraDescription read_camera(const JsonReader& json);
void read_output(const JsonReader& json, PictureOptions& picture);

} // namespace kokage
