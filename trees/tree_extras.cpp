#include "trees/tree_extras.h"

#include "common/services/random.h"
#include "trees/extras_reader.h"
#include "trees/foreign_tree.h"
#include "trees/height_extras.h"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

namespace kokage {
namespace {

constexpr std::uint32_t kNone = ~0u;

/// A running hash of arrays' bits.
class Fingerprint {
  public:
    void add(std::uint64_t value) { state_ = hash64(state_ ^ value); }
    template <typename Value>
    void add(const std::vector<Value>& values) {
        add(std::uint64_t(values.size()));
        for (const Value& value : values)
            add_value(value);
    }
    std::string text() const {
        char digits[17];
        std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(state_));
        return digits;
    }

  private:
    void add_value(std::uint32_t value) { add(std::uint64_t(value)); }
    void add_value(float value) { add(std::uint64_t(std::bit_cast<std::uint32_t>(value))); }
    void add_value(const glm::vec3& v) {
        for (std::size_t c = 0; c < 3; ++c)
            add_value(v[c]);
    }
    void add_value(const glm::vec4& v) {
        for (std::size_t c = 0; c < 4; ++c)
            add_value(v[c]);
    }
    void add_value(const glm::uvec3& v) {
        for (std::size_t c = 0; c < 3; ++c)
            add_value(v[c]);
    }

    std::uint64_t state_ = 1;
};

/// The skeleton, leaves and light maps as plain arrays, the same when writing and reading.
struct Arrays {
    std::vector<std::uint32_t> parent, order, node_count;
    std::vector<glm::vec4> nodes;
    std::vector<glm::vec3> leaf_centre;
    std::vector<std::uint32_t> leaf_branch;
    std::vector<glm::vec3> map_position, map_coefficients;
    std::vector<float> map_radius;
    std::vector<std::uint32_t> map_generation, map_bands;
};

Arrays arrays_of(const Tree& tree, const ShadedAttributes* shaded) {
    Arrays a;
    for (const Branch& branch : tree.skeleton.branches) {
        a.parent.push_back(std::uint32_t(branch.parent));
        a.order.push_back(std::uint32_t(branch.order));
        a.node_count.push_back(std::uint32_t(branch.nodes.size()));
        for (const Branch::Node& node : branch.nodes)
            a.nodes.emplace_back(node.position, node.radius_m);
    }
    for (const Leaf& leaf : tree.leaves) {
        a.leaf_centre.push_back(leaf.centre);
        a.leaf_branch.push_back(std::uint32_t(leaf.branch));
    }
    if (shaded)
        for (const LightMap& map : shaded->light_maps) {
            a.map_position.push_back(map.position);
            a.map_radius.push_back(map.radius_m);
            a.map_generation.push_back(std::uint32_t(map.generation));
            a.map_bands.push_back(std::uint32_t(map.bands));
            a.map_coefficients.insert(a.map_coefficients.end(), map.coefficients.begin(), map.coefficients.end());
        }
    return a;
}

std::string fingerprint_of(const Arrays& a, const Tree& tree) {
    Fingerprint fingerprint;
    fingerprint.add(a.parent);
    fingerprint.add(a.order);
    fingerprint.add(a.node_count);
    fingerprint.add(a.nodes);
    fingerprint.add(a.leaf_centre);
    fingerprint.add(a.leaf_branch);
    fingerprint.add(a.map_position);
    fingerprint.add(a.map_radius);
    fingerprint.add(a.map_generation);
    fingerprint.add(a.map_bands);
    fingerprint.add(a.map_coefficients);
    for (const TreePart& part : tree.parts) {
        if (part.triangles.empty())
            continue;
        fingerprint.add(part.positions);
        fingerprint.add(part.triangles);
        fingerprint.add(part.triangle_patch);
    }
    return fingerprint.text();
}

void read_skeleton(ExtrasReader& reader, const nlohmann::json& extras, Arrays& a) {
    const nlohmann::json& skeleton = reader.member(extras, "skeleton");
    const std::uint64_t branches = reader.count(skeleton, "branches");
    a.parent = reader.integers(skeleton, "parent", branches);
    a.order = reader.integers(skeleton, "order", branches);
    a.node_count = reader.integers(skeleton, "node_count", branches);
    std::uint64_t nodes = 0;
    for (const std::uint32_t count : a.node_count)
        nodes += count;
    a.nodes = reader.vectors<glm::vec4>(skeleton, "nodes", nodes);
    const nlohmann::json& leaves = reader.member(extras, "leaves");
    const std::uint64_t leaf_count = reader.count(leaves, "count");
    a.leaf_centre = reader.vectors<glm::vec3>(leaves, "centre", leaf_count);
    a.leaf_branch = reader.integers(leaves, "branch", leaf_count);
}

void read_light_maps(ExtrasReader& reader, const nlohmann::json& extras, Arrays& a) {
    const nlohmann::json& maps = reader.member(extras, "light_maps");
    const std::uint64_t count = reader.count(maps, "count");
    a.map_position = reader.vectors<glm::vec3>(maps, "position", count);
    a.map_radius = reader.floats(maps, "radius", count);
    a.map_generation = reader.integers(maps, "generation", count);
    a.map_bands = reader.integers(maps, "bands", count);
    std::uint64_t coefficients = 0;
    for (const std::uint32_t bands : a.map_bands)
        coefficients += std::uint64_t(bands) * bands;
    a.map_coefficients = reader.vectors<glm::vec3>(maps, "coefficients", coefficients);
}

/// Fills skeleton and leaves; false if they contradict themselves.
bool unpack(const Arrays& a, OwnTree& own) {
    std::size_t node = 0;
    for (std::size_t b = 0; b < a.parent.size(); ++b) {
        Branch branch;
        branch.parent = std::int32_t(a.parent[b]);
        branch.order = int(a.order[b]);
        if ((a.parent[b] != kNone && a.parent[b] >= b) || a.order[b] > 1000000 || a.node_count[b] == 0)
            return false;
        for (std::uint32_t n = 0; n < a.node_count[b]; ++n, ++node)
            branch.nodes.push_back({glm::vec3(a.nodes[node]), a.nodes[node].w});
        own.tree.skeleton.branches.push_back(std::move(branch));
    }
    for (std::size_t i = 0; i < a.leaf_centre.size(); ++i) {
        if (a.leaf_branch[i] != kNone && a.leaf_branch[i] >= a.parent.size())
            return false;
        own.tree.leaves.push_back({a.leaf_centre[i], std::int32_t(a.leaf_branch[i])});
    }
    std::size_t coefficient = 0;
    for (std::size_t i = 0; i < a.map_position.size(); ++i) {
        LightMap map;
        map.position = a.map_position[i];
        map.radius_m = a.map_radius[i];
        map.generation = int(a.map_generation[i]);
        map.bands = int(a.map_bands[i]);
        const std::size_t count = std::size_t(map.bands) * std::size_t(map.bands);
        map.coefficients.assign(a.map_coefficients.begin() + std::ptrdiff_t(coefficient),
                                a.map_coefficients.begin() + std::ptrdiff_t(coefficient + count));
        coefficient += count;
        own.light_maps.push_back(std::move(map));
    }
    return true;
}

/// The part that a primitive holds, vertices that were repeated for patches put together again.
bool read_part(ExtrasReader& reader, const nlohmann::json& entry, const MeshScene& scene, OwnTree& own) {
    const std::string kind = reader.text(entry, "kind");
    const nlohmann::json& mesh = reader.member(entry, "mesh");
    const nlohmann::json& primitive = reader.member(entry, "primitive");
    TreePart part;
    part.kind = kind == "foliage" ? TreePartKind::foliage : TreePartKind::bark;
    part.material = std::uint32_t(reader.count(entry, "material"));
    const std::uint64_t vertices = reader.count(entry, "vertices"), triangles = reader.count(entry, "triangles");
    const std::uint64_t duplicates = reader.count(entry, "duplicates");
    if (!reader.good || !mesh.is_number_integer() || !primitive.is_number_integer() ||
        part.material >= own.tree.materials.size())
        return false;
    PartPlace place;
    place.mesh = mesh.get<int>();
    place.primitive = primitive.get<int>();
    std::map<std::string, int> attributes;
    if (place.mesh >= 0) {
        const auto found = std::find_if(scene.meshes.begin(), scene.meshes.end(), [&](const SceneMesh& candidate) {
            return candidate.mesh_index == place.mesh && candidate.primitive_index == place.primitive;
        });
        if (found == scene.meshes.end() || found->positions.size() != vertices + duplicates ||
            found->triangles.size() != triangles)
            return false;
        place.duplicate_of = reader.integers(entry, "duplicate_of", duplicates);
        part.triangle_patch = reader.integers(entry, "triangle_patch", triangles);
        const std::size_t limit =
            part.kind == TreePartKind::foliage ? own.tree.leaves.size() : own.tree.bark_patch_count;
        for (const std::uint32_t patch : part.triangle_patch)
            reader.good = reader.good && patch < limit;
        for (const std::uint32_t source : place.duplicate_of)
            reader.good = reader.good && source < vertices;
        if (!reader.good)
            return false;
        part.positions.assign(found->positions.begin(), found->positions.begin() + std::ptrdiff_t(vertices));
        part.normals.assign(found->normals.begin(), found->normals.begin() + std::ptrdiff_t(vertices));
        if (!found->uvs.empty())
            part.uvs.assign(found->uvs.begin(), found->uvs.begin() + std::ptrdiff_t(vertices));
        part.triangles = found->triangles;
        for (glm::uvec3& triangle : part.triangles)
            for (std::size_t c = 0; c < 3; ++c)
                if (triangle[c] >= vertices)
                    triangle[c] = place.duplicate_of[triangle[c] - vertices];
        attributes = found->custom_attributes;
    }
    own.tree.parts.push_back(std::move(part));
    own.places.push_back(std::move(place));
    own.attributes.push_back(std::move(attributes));
    return reader.good;
}

bool read_materials(ExtrasReader& reader, const nlohmann::json& extras, const MeshScene& scene, Tree& tree) {
    const nlohmann::json& materials = reader.list(extras, "materials");
    const BarkHeights heights = read_heights(reader, extras);
    if (!reader.good || materials.size() >= scene.materials.size() + 1)
        return false;
    std::vector<std::string> ignored;
    for (std::size_t m = 0; m < materials.size(); ++m) {
        TreeMaterial material = tree_material(scene.materials[m], glm::vec3(1.f), ignored);
        material.double_sided = reader.flag(materials[m], "double_sided");
        if (!reader.flag(materials[m], "has_color"))
            material.base_color_texture = nullptr;
        if (const nlohmann::json& transmission = reader.list(materials[m], "diffuse_transmission");
            transmission.size() == 4) {
            const auto number = [&](std::size_t i) {
                return transmission[i].is_number() ? transmission[i].get<float>() : 0.f;
            };
            material.diffuse_transmission = number(0);
            material.diffuse_transmission_color = {number(1), number(2), number(3)};
        }
        read_relief(reader, materials[m], heights, material);
        tree.materials.push_back(std::move(material));
    }
    return reader.good;
}

std::optional<glm::dvec3> read_origin(const nlohmann::json& extras) {
    const auto found = extras.find("origin");
    if (found == extras.end() || !found->is_array() || found->size() != 3)
        return std::nullopt;
    glm::dvec3 origin;
    for (std::size_t c = 0; c < 3; ++c) {
        if (!(*found)[c].is_number())
            return std::nullopt;
        origin[c] = (*found)[c].get<double>();
    }
    return origin;
}

} // namespace

nlohmann::json write_extras(GltfWriter& writer, const Tree& tree, const std::vector<PartPlace>& places,
                            const ShadedAttributes* shaded, float scale) {
    const Arrays a = arrays_of(tree, shaded);
    nlohmann::json extras;
    extras["version"] = 1;
    extras["name"] = tree.name;
    extras["source"] = tree.source;
    extras["notes"] = tree.notes;
    extras["branching_known"] = tree.branching_known;
    extras["origin"] = {tree.origin.x, tree.origin.y, tree.origin.z};
    const auto data = [&](const auto& values, const char* name) {
        return writer.add(std::span(values), GltfArrayUse::data, name);
    };
    extras["skeleton"] = {{"branches", a.parent.size()},
                          {"parent", data(a.parent, "parent of branch")},
                          {"order", data(a.order, "order of branch")},
                          {"node_count", data(a.node_count, "nodes of branch")},
                          {"nodes", data(a.nodes, "skeleton node")}};
    extras["leaves"] = {{"count", a.leaf_centre.size()},
                        {"centre", data(a.leaf_centre, "centre of leaf")},
                        {"branch", data(a.leaf_branch, "branch of leaf")}};
    extras["bark_patches"] = tree.bark_patch_count;
    const BarkHeights heights = heights_of(tree.materials);
    extras["heights"] = write_heights(writer, heights);
    extras["materials"] = nlohmann::json::array();
    for (const TreeMaterial& material : tree.materials) {
        nlohmann::json entry = {{"double_sided", material.double_sided},
                                {"has_color", material.base_color_texture && !material.base_color_texture->empty()}};
        const glm::vec3& color = material.diffuse_transmission_color;
        if (material.diffuse_transmission >= 0)
            entry["diffuse_transmission"] = {material.diffuse_transmission, color.r, color.g, color.b};
        write_relief(material, heights, entry);
        extras["materials"].push_back(std::move(entry));
    }
    extras["parts"] = nlohmann::json::array();
    for (std::size_t p = 0; p < tree.parts.size(); ++p) {
        const TreePart& part = tree.parts[p];
        extras["parts"].push_back({{"kind", part.kind == TreePartKind::foliage ? "foliage" : "bark"},
                                   {"material", part.material},
                                   {"mesh", places[p].mesh},
                                   {"primitive", places[p].primitive},
                                   {"vertices", part.positions.size()},
                                   {"triangles", part.triangles.size()},
                                   {"duplicates", places[p].duplicate_of.size()},
                                   {"duplicate_of", data(places[p].duplicate_of, "repeated vertex")},
                                   {"triangle_patch", data(part.triangle_patch, "patch of triangle")}});
    }
    extras["light_maps"] = {{"count", a.map_position.size()},
                            {"position", data(a.map_position, "position of light map")},
                            {"radius", data(a.map_radius, "radius of light map")},
                            {"generation", data(a.map_generation, "generation of light map")},
                            {"bands", data(a.map_bands, "bands of light map")},
                            {"coefficients", data(a.map_coefficients, "coefficients of light maps")}};
    if (shaded)
        extras["shaded"] = {{"scale", scale}};
    extras["fingerprint"] = fingerprint_of(a, tree);
    return extras;
}

std::optional<OwnTree> read_own_tree(const GltfDocument& document, std::string& why, Progress& progress) {
    const nlohmann::json& all = document.extras();
    const auto found = all.is_object() ? all.find("kokage") : all.end();
    if (!all.is_object() || found == all.end() || !found->is_object())
        return std::nullopt;
    const nlohmann::json& extras = *found;
    ExtrasReader reader(document);
    if (reader.count(extras, "version") != 1) {
        why = "it was written by another version of Kokage";
        return std::nullopt;
    }
    why = "it was edited by another program since Kokage wrote it";
    OwnTree own;
    Arrays arrays;
    const std::optional<glm::dvec3> origin = read_origin(extras);
    read_skeleton(reader, extras, arrays);
    read_light_maps(reader, extras, arrays);
    if (!origin || !reader.good || !unpack(arrays, own))
        return std::nullopt;
    own.tree.origin = *origin;
    own.tree.name = reader.text(extras, "name");
    own.tree.source = reader.text(extras, "source");
    own.tree.branching_known = reader.flag(extras, "branching_known");
    own.tree.bark_patch_count = std::uint32_t(reader.count(extras, "bark_patches"));
    for (const nlohmann::json& note : reader.list(extras, "notes"))
        if (note.is_string())
            own.tree.notes.push_back(note.get<std::string>());
    const nlohmann::json& parts = reader.list(extras, "parts");
    if (!reader.good)
        return std::nullopt;
    const bool has_mesh = std::any_of(parts.begin(), parts.end(), [](const nlohmann::json& part) {
        return part.is_object() && part.value("mesh", nlohmann::json(-1)) != nlohmann::json(-1);
    });
    MeshScene scene;
    if (has_mesh)
        scene = flatten(document, own.tree.origin, progress);
    else
        scene.materials.resize(document.model().materials.size() + 1);
    if (!read_materials(reader, extras, scene, own.tree))
        return std::nullopt;
    for (const nlohmann::json& part : parts)
        if (!read_part(reader, part, scene, own))
            return std::nullopt;
    // Memory is taken for each patch, and each has triangles.
    std::size_t triangles = 0;
    for (const TreePart& part : own.tree.parts)
        triangles += part.triangles.size();
    if (own.tree.bark_patch_count > triangles)
        return std::nullopt;
    if (reader.text(extras, "fingerprint") != fingerprint_of(arrays, own.tree) || !reader.good)
        return std::nullopt;
    if (const auto shaded = extras.find("shaded"); shaded != extras.end() && shaded->is_object()) {
        own.shaded = true;
        const nlohmann::json& scale = reader.member(*shaded, "scale");
        own.scale = scale.is_number() ? scale.get<float>() : 1.f;
    }
    why.clear();
    return own;
}

} // namespace kokage
