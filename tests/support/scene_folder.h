#pragma once
// A scene that uses all that scenes can say, in a folder with the (empty) files that it names.
#include "common/services/error.h"
#include "tests/support/temporary_folder.h"
#include "viewer/scene/read_scene.h"

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

namespace kokage {

class SceneFolder {
  public:
    SceneFolder() : folder_(parent_in_memory()) {
        for (const char* file :
             {"studio.hdr", "tree.glb", "pot.obj", "cup.stl", "color.png", "rough.jpg", "heights.png", "normals.png"})
            write(file, "");
        write("my.json", R"({"name": "my birch", "parameters": {"leaves": 500}})");
        write("other.json", R"({"kokage_scene": 1, "trees": [{"species": "oak"}]})");
        std::filesystem::create_directory(folder_ / "folder.png");
    }

    void write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary | std::ios::trunc) << text;
    }
    std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

    SceneDescription read(const std::string& text, const std::filesystem::path& data = {}) const {
        write("scene.json", text);
        return read_scene(folder_ / "scene.json", data);
    }
    /// The complaint about a scene; empty if there is none.
    std::string complaint(const std::string& text) const {
        try {
            read(text);
            return "";
        } catch (const InputError& error) {
            return error.what();
        }
    }

    static nlohmann::json good_scene() {
        return nlohmann::json::parse(R"({
            "$schema": "scene.schema.json",
            "kokage_scene": 1,
            "environment": {"image": "studio.hdr", "turn": 90, "strict": true},
            "lights": [{"sun": [220, 30], "irradiance": [9, 8.5, 7]},
                       {"disc": [10, 60], "half_angle": 4, "irradiance": 2},
                       {"directional": [0, -20], "irradiance": 0.5},
                       {"point": [2, 3, 1], "intensity": [5, 4, 3]}],
            "ground": {"albedo": [0.17, 0.16, 0.09]},
            "materials": {
                "bark": {"roughness": 0.8, "roughness_texture": "rough.jpg", "metallic": 0,
                         "relief": {"heights": "heights.png", "depth": 0.02}},
                "leaf": {"roughness": 0.4, "index_of_refraction": 1.5, "relief": {}},
                "glaze": {"base_color": [0.1, 0.2, 0.6], "base_color_texture": "color.png",
                          "roughness_from_foot_to_top": [0.15, 0.7],
                          "relief": {"normals": "normals.png", "repeat": 0.5}}
            },
            "trees": [{"species": "oak", "leaves": 3000, "seed": 4, "set": {"season": "autumn", "branch_angle": 50.5},
                       "at": [1, -2], "turn": 30, "size": 1.5, "leaf_material": "leaf", "bark_material": "bark"},
                      {"species": "my.json"},
                      {"file": "tree.glb", "foliage": ["Leaves"], "leaf_size": 0.1, "scale": 0.01, "up": "z",
                       "at": [4, 0.5, 3]}],
            "objects": [{"file": "pot.obj", "up": "z", "height": 0.4, "at": [2, 1], "turn": -45, "material": "glaze"},
                        {"file": "cup.stl", "size": 0.001}],
            "camera": {"position": [0, 1.6, 12], "target": [0, 3, 0], "field_of_view": 40},
            "output": {"size": [640, 480], "samples": 32, "exposure": -0.5, "seed": 7}
        })");
    }

  private:
    TemporaryFolder folder_;
};

} // namespace kokage
