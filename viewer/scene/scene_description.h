#pragma once
// What a scene file tells (viewer/scene/README.md): trees and objects in their places, their materials, light, ground,
// camera, picture. Names of files are already found; nothing is loaded yet.
#include "common/types.h"
#include "reflection/picture.h"
#include "viewer/scene/surroundings.h"
#include "viewer/scene/tree_source.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace kokage {

/// Relief of a material: where its heights come from and how large they are.
struct ReliefDescription {
    bool none = false;             ///< the bark's own is left out
    std::filesystem::path heights; ///< an image of heights, white = outside; empty: `normals`, or the bark's own
    std::filesystem::path normals; ///< an OpenGL normal map, whose heights are found
    double depth_m = 0;            ///< from white to black; 0: as the bark's own, times `scale`
    double scale = 1;
    double repeat_m = 0; ///< normals: width of a tile in metres, to give its heights a scale; 0: depth_m is known
};

/// What is given replaces what the tree or object brought; the rest stays.
struct MaterialDescription {
    std::optional<glm::vec3> base_color; ///< linear
    std::filesystem::path base_color_texture;
    std::optional<double> roughness;         ///< glTF's, 0 .. 1
    std::filesystem::path roughness_texture; ///< first channel (glTF's G if it has three), times `roughness`
    /// From the lowest to the highest point of what wears it (height, +Y), linearly.
    std::optional<glm::dvec2> roughness_from_foot_to_top;
    std::optional<double> metallic;            ///< 0: plastic, wood, leaf; 1: a metal of the base colour
    std::optional<double> index_of_refraction; ///< of what is no metal; 1: matt
    std::optional<ReliefDescription> relief;
    std::string pointer; ///< where it stands in the file, for messages
};

/// First scaled about its own origin, then turned about +Y (degrees, from +Z towards +X), then moved.
struct Placement {
    glm::dvec3 at{0.0}; ///< metres; where the foot stands
    double turn_degrees = 0, size = 1;
};

struct PlacedTree {
    TreeSource source;
    std::optional<std::uint64_t> seed; ///< species; empty: the parameters' own
    Placement placement;
    std::string leaf_material, bark_material; ///< names in `materials`; empty: the tree's own
    std::string pointer;
};

struct PlacedObject {
    std::filesystem::path file;     ///< glTF, GLB, OBJ, STL
    std::string up = "y";           ///< the file's axis that is up: "y" or "z"
    std::optional<double> height_m; ///< scaled to be this high; else its units are metres
    Placement placement;            ///< of the middle of its foot
    std::string material;           ///< empty: the file's own
    std::string pointer;
};

struct CameraDescription {
    std::optional<glm::dvec3> position, target; ///< both, or neither: frame_scene chooses
    std::optional<double> azimuth_degrees;      ///< neither given: from where frame_scene looks; empty: photographer's
    double vertical_field_of_view_degrees = 34;
};

struct SceneDescription {
    std::string name;           ///< the file's stem, or the tree's
    std::filesystem::path file; ///< empty for "just a tree"
    Surroundings surroundings;
    double environment_turn_degrees = 0; ///< images: about +Y
    std::map<std::string, MaterialDescription> materials;
    std::vector<PlacedTree> trees;
    std::vector<PlacedObject> objects;
    CameraDescription camera;
    PictureOptions picture;            ///< size, samples, exposure, seed
    std::vector<std::string> warnings; ///< what is there, but changes nothing
};

} // namespace kokage
