#pragma once
// Texts about scene files that are part of the program.
#include <string_view>

namespace kokage {

/// The JSON Schema (draft-07) of scene files, viewer/scene.schema.json.
std::string_view scene_schema_text();

/// A scene with comments to start from, viewer/scene/example.json. It names no file that must be there.
std::string_view scene_example_text();

} // namespace kokage
