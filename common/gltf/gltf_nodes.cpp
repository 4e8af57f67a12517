#include "common/gltf/gltf_nodes.h"

#include "common/gltf/check_gltf.h"
#include "common/gltf/gltf_values.h"
#include "common/services/count_text.h"
#include "common/services/named_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <map>

namespace kokage {
namespace {

bool is_finite(const glm::dmat4& m) {
    for (std::size_t i = 0; i < 16; ++i)
        if (!std::isfinite(m[i / 4][i % 4]))
            return false;
    return true;
}

glm::dmat4 translate_rotate_scale(const glm::dvec3& translation, const glm::dquat& rotation, const glm::dvec3& scale) {
    glm::dmat4 result(1.0);
    for (std::size_t c = 0; c < 3; ++c)
        result[c][c] = scale[c];
    if (glm::length(rotation) > 0)
        result = glm::mat4_cast(glm::normalize(rotation)) * result;
    result[3] = glm::dvec4(translation, 1.0);
    return result;
}

glm::dmat4 local_transform(const GltfDocument& document, int index) {
    const tinygltf::Node& node = document.model().nodes[std::size_t(index)];
    glm::dmat4 result(1.0);
    if (node.matrix.size() == 16) {
        for (std::size_t i = 0; i < 16; ++i)
            result[i / 4][i % 4] = node.matrix[i];
    } else {
        glm::dvec3 translation(0.0), scale(1.0);
        glm::dquat rotation(1, 0, 0, 0);
        if (node.scale.size() == 3)
            scale = {node.scale[0], node.scale[1], node.scale[2]};
        if (node.rotation.size() == 4)
            rotation = glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
        if (node.translation.size() == 3)
            translation = {node.translation[0], node.translation[1], node.translation[2]};
        result = translate_rotate_scale(translation, rotation, scale);
    }
    if (!is_finite(result))
        document.fail("node " + std::to_string(index) + " has a transform that is not finite");
    return result;
}

/// EXT_mesh_gpu_instancing: the node's transform, then each instance's; one transform for a node without it.
std::vector<glm::dmat4> instance_transforms(const GltfDocument& document, int index, const glm::dmat4& world) {
    const tinygltf::Node& node = document.model().nodes[std::size_t(index)];
    const auto extension = node.extensions.find("EXT_mesh_gpu_instancing");
    if (extension == node.extensions.end())
        return {world};
    const std::string place = "node " + std::to_string(index) + ", EXT_mesh_gpu_instancing";
    const tinygltf::Value& attributes = member(extension->second, "attributes");
    std::size_t count = 0;
    bool first = true;
    const auto values = [&](const char* name, int components) {
        const tinygltf::Value& accessor = member(attributes, name);
        if (!accessor.IsInt())
            return std::vector<float>();
        std::vector<float> result = document.floats(accessor.Get<int>(), components);
        const std::size_t here = result.size() / std::size_t(components);
        if (!first && here != count)
            document.fail(place + ": " + name + " has " + std::to_string(here) + " elements for " +
                          std::to_string(count) + " instances");
        count = here;
        first = false;
        return result;
    };
    const std::vector<float> translation = values("TRANSLATION", 3), rotation = values("ROTATION", 4),
                             scale = values("SCALE", 3);
    if (first)
        document.fail(place + " has none of TRANSLATION, ROTATION and SCALE");
    std::vector<glm::dmat4> transforms;
    transforms.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto vector = [&](const std::vector<float>& from, double missing) {
            return from.empty() ? glm::dvec3(missing) : glm::dvec3(from[3 * i], from[3 * i + 1], from[3 * i + 2]);
        };
        const glm::dquat turn = rotation.empty() ? glm::dquat(1, 0, 0, 0)
                                                 : glm::dquat(rotation[4 * i + 3], rotation[4 * i], rotation[4 * i + 1],
                                                              rotation[4 * i + 2]);
        transforms.push_back(world * translate_rotate_scale(vector(translation, 0.0), turn, vector(scale, 1.0)));
        if (!is_finite(transforms.back()))
            document.fail(place + ": instance " + std::to_string(i) + " has a transform that is not finite");
    }
    return transforms;
}

} // namespace

GltfNodes::GltfNodes(const GltfDocument& document) : document_(document), parent_(document.model().nodes.size(), -1) {
    const auto& nodes = document.model().nodes;
    for (std::size_t i = 0; i < nodes.size(); ++i)
        for (const int child : nodes[i].children) {
            check_node(child, "node " + std::to_string(i));
            if (parent_[std::size_t(child)] >= 0 || child == int(i))
                document.fail("node " + std::to_string(child) + " is a child of two nodes, or of itself");
            parent_[std::size_t(child)] = int(i);
        }
    order_nodes();
}

/// Parents before children, each node's children in order; and the products of transforms along the way.
void GltfNodes::order_nodes() {
    const auto& nodes = document_.model().nodes;
    world_.resize(nodes.size());
    std::vector<int> stack = all_roots();
    std::reverse(stack.begin(), stack.end());
    while (!stack.empty()) {
        const int index = stack.back();
        stack.pop_back();
        order_.push_back(index);
        const int up = parent_[std::size_t(index)];
        const glm::dmat4 local = local_transform(document_, index);
        world_[std::size_t(index)] = up < 0 ? local : world_[std::size_t(up)] * local;
        const std::vector<int>& children = nodes[std::size_t(index)].children;
        stack.insert(stack.end(), children.rbegin(), children.rend());
    }
    if (order_.size() != nodes.size())
        document_.fail("its nodes form a cycle: some are their own ancestors");
}

void GltfNodes::check_node(int index, const std::string& place) const {
    if (index < 0 || std::size_t(index) >= document_.model().nodes.size())
        document_.fail(place + ": node " + std::to_string(index) + " does not exist");
}

bool GltfNodes::has_mesh(std::size_t scene) const {
    std::vector<int> stack = document_.model().scenes[scene].nodes;
    std::size_t steps = 0;
    while (!stack.empty() && steps++ <= document_.model().nodes.size()) {
        const int index = stack.back();
        stack.pop_back();
        if (index < 0 || std::size_t(index) >= document_.model().nodes.size())
            continue;
        const tinygltf::Node& node = document_.model().nodes[std::size_t(index)];
        if (node.mesh >= 0)
            return true;
        stack.insert(stack.end(), node.children.begin(), node.children.end());
    }
    return false;
}

std::vector<int> GltfNodes::all_roots() const {
    std::vector<int> result;
    for (std::size_t i = 0; i < parent_.size(); ++i)
        if (parent_[i] < 0)
            result.push_back(int(i));
    return result;
}

/// Some exporters list a child among a scene's roots, and sometimes its parent as well; some list nothing.
std::vector<int> GltfNodes::roots(std::vector<std::string>& notes) const {
    const tinygltf::Model& model = document_.model();
    if (model.scenes.empty())
        return all_roots();
    const std::size_t wanted = model.defaultScene >= 0 && std::size_t(model.defaultScene) < model.scenes.size()
                                   ? std::size_t(model.defaultScene)
                                   : 0;
    for (const int index : model.scenes[wanted].nodes)
        check_node(index, "scene " + std::to_string(wanted));
    std::vector<std::size_t> filled;
    for (std::size_t s = 0; s < std::min<std::size_t>(model.scenes.size(), 64); ++s)
        if (has_mesh(s))
            filled.push_back(s);
    if (filled.empty()) {
        notes.push_back("its scenes are empty: all nodes were read");
        return all_roots();
    }
    std::size_t chosen = wanted;
    if (std::find(filled.begin(), filled.end(), wanted) == filled.end()) {
        chosen = filled.front();
        notes.push_back("the default scene is empty: scene " + std::to_string(chosen) + " was read");
    }
    for (const std::size_t s : filled)
        if (s != chosen)
            notes.push_back("scene " + std::to_string(s) +
                            (model.scenes[s].name.empty() ? "" : " '" + shown_name(model.scenes[s].name) + "'") +
                            " was left out: one scene is read");
    for (const int index : model.scenes[chosen].nodes)
        check_node(index, "scene " + std::to_string(chosen));
    return model.scenes[chosen].nodes;
}

/// Drawn nodes named "<stem>LOD<n>" beside a finer one of the same stem and parent.
std::vector<bool> GltfNodes::coarser_levels(const std::vector<bool>& drawn, std::vector<std::string>& notes) const {
    const auto& nodes = document_.model().nodes;
    struct Level {
        int number, node;
    };
    std::map<std::pair<int, std::string>, std::vector<Level>> levels;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const std::string& name = nodes[i].name;
        std::size_t digits = name.size();
        while (digits > 0 && std::isdigit(static_cast<unsigned char>(name[digits - 1])))
            --digits;
        if (!drawn[i] || digits == name.size() || name.size() - digits > 2 || digits < 3)
            continue;
        std::string word = name.substr(digits - 3, 3);
        std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return char(std::tolower(c)); });
        if (word == "lod")
            levels[{parent_[i], name.substr(0, digits - 3)}].push_back({std::stoi(name.substr(digits)), int(i)});
    }
    std::vector<bool> coarser(nodes.size(), false);
    std::size_t left_out = 0;
    for (const auto& [stem, found] : levels) {
        const int finest = std::min_element(found.begin(), found.end(), [](const Level& a, const Level& b) {
                               return a.number < b.number;
                           })->number;
        for (const Level& level : found)
            if (level.number > finest) {
                coarser[std::size_t(level.node)] = true;
                ++left_out;
            }
    }
    if (left_out > 0)
        notes.push_back(counted(left_out, "coarser level of detail was", "coarser levels of detail were") +
                        " left out, by their nodes' names (LOD1, ...)");
    return coarser;
}

std::vector<GltfPlacement> GltfNodes::placements(std::vector<std::string>& notes) const {
    std::vector<bool> drawn(parent_.size(), false);
    for (const int root : roots(notes))
        drawn[std::size_t(root)] = true;
    for (const int index : order_)
        if (const int up = parent_[std::size_t(index)]; up >= 0 && drawn[std::size_t(up)])
            drawn[std::size_t(index)] = true;
    std::vector<bool> hidden = coarser_levels(drawn, notes);
    std::vector<GltfPlacement> result;
    std::size_t instances = 0;
    for (const int index : order_) {
        const int up = parent_[std::size_t(index)];
        hidden[std::size_t(index)] = hidden[std::size_t(index)] || (up >= 0 && hidden[std::size_t(up)]);
        const int mesh = document_.model().nodes[std::size_t(index)].mesh;
        if (!drawn[std::size_t(index)] || hidden[std::size_t(index)] || mesh < 0)
            continue;
        if (std::size_t(mesh) >= document_.model().meshes.size())
            document_.fail("node " + std::to_string(index) + ": mesh " + std::to_string(mesh) + " does not exist");
        result.push_back({mesh, index, instance_transforms(document_, index, world_[std::size_t(index)])});
        instances += result.back().transforms.size();
        if (instances > kMaximumInstances)
            document_.fail("its scene has more than the limit of " + std::to_string(kMaximumInstances) +
                           " instances of meshes");
    }
    return result;
}

} // namespace kokage
