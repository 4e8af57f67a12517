#pragma once
// MTL files. Private to common/obj.
#include "common/scene/mesh_scene.h"

#include <filesystem>
#include <string_view>

namespace kokage {

/// True if the comments at a text's begin say so, as those of Blender's OBJ and MTL files do in all versions.
bool is_written_by_blender(std::string_view text);

/// Materials by name, read from the MTL files that an OBJ names.
class ObjMaterials {
  public:
    /// `path`: of the OBJ, for messages.
    ObjMaterials(std::filesystem::path path, std::vector<std::string>& notes);

    /// From now on Kd is linear whatever an MTL says of itself; else it is so where Blender wrote the MTL.
    void take_kd_as_linear() { kd_is_linear_ = true; }
    /// From now on what no MTL describes is white, and coloured by its vertices.
    void take_colors_of_vertices() { vertices_have_colors_ = true; }

    /// Reads the file or files that a `mtllib` line names; one that is not there is noted.
    void read_library(const std::string& names);

    /// The index of a material in materials(); one that no file describes is made up, and noted. "" is the material of
    /// faces before any `usemtl`.
    int index_of(const std::string& name);

    const std::vector<SceneMaterial>& materials() const { return materials_; }
    /// For uv of a material: uv' = offset + scale * uv, before v is turned.
    struct TextureOptions {
        glm::vec2 offset{0.f}, scale{1.f};
    };
    const TextureOptions& options(int material) const { return options_[std::size_t(material)]; }

  private:
    void read_file(const std::filesystem::path& file);

    std::filesystem::path path_;
    std::vector<std::string>& notes_;
    std::vector<SceneMaterial> materials_;
    std::vector<TextureOptions> options_;
    std::map<std::string, int> by_name_;
    std::map<std::string, Image> images_; ///< by path
    std::uint64_t pixels_ = 0;
    bool kd_is_linear_ = false, vertices_have_colors_ = false;
    friend class MaterialTextures;
};

} // namespace kokage
