#include "trees/write_tree.h"

#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "trees/patches.h"
#include "trees/tree_extras.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

namespace kokage {
namespace {

std::size_t patch_number(const Tree& tree, const TreePart& part, std::size_t triangle) {
    return part.triangle_patch[triangle] + (part.kind == TreePartKind::bark ? tree.leaves.size() : 0);
}

void check_tree(const Tree& tree, const ShadedAttributes* shaded) {
    const std::string where = "can't write tree '" + shown_name(tree.name) + "': ";
    for (std::size_t p = 0; p < tree.parts.size(); ++p) {
        const TreePart& part = tree.parts[p];
        const std::string place = where + "part " + std::to_string(p) + " ";
        if (part.normals.size() != part.positions.size() ||
            (!part.uvs.empty() && part.uvs.size() != part.positions.size()) ||
            part.triangle_patch.size() != part.triangles.size())
            throw InputError(place + "has arrays of different lengths");
        if (part.material >= tree.materials.size())
            throw InputError(place + "names material " + std::to_string(part.material) + " of " +
                             std::to_string(tree.materials.size()));
        const std::size_t limit = part.kind == TreePartKind::foliage ? tree.leaves.size() : tree.bark_patch_count;
        for (std::size_t t = 0; t < part.triangles.size(); ++t)
            if (part.triangle_patch[t] >= limit ||
                std::max({part.triangles[t].x, part.triangles[t].y, part.triangles[t].z}) >= part.positions.size())
                throw InputError(place + "has indices out of range at triangle " + std::to_string(t));
    }
    if (!shaded)
        return;
    const std::size_t patches = tree.leaves.size() + tree.bark_patch_count;
    const auto fits = [&](const std::vector<glm::vec3>& values, bool may_be_empty) {
        return values.size() == patches || (may_be_empty && values.empty());
    };
    if (!fits(shaded->radiance_front, false) || !fits(shaded->radiance_back, false) ||
        !fits(shaded->indirect_front, true) || shaded->indirect_back.size() != shaded->indirect_front.size())
        throw InputError(where + std::to_string(shaded->radiance_front.size()) + " radiances for " +
                         std::to_string(patches) + " patches");
    for (std::size_t i = 0; i < patches; ++i)
        for (const glm::vec3& value : {shaded->radiance_front[i], shaded->radiance_back[i]})
            if (!std::isfinite(value.r + value.g + value.b))
                throw InputError(where + "the radiance of patch " + std::to_string(i) + " is not finite");
}

/// The colours that make viewers show the shading: radiance / base colour / scale.
class ShadingColors {
  public:
    ShadingColors(const Tree& tree, const ShadedAttributes& shaded) : tree_(tree), shaded_(shaded) {
        base_.resize(tree.leaves.size() + tree.bark_patch_count, glm::vec3(1.f));
        std::map<std::pair<std::uint32_t, TreePartKind>, glm::vec3> means;
        for (const TreePart& part : tree.parts) {
            const auto [mean, is_new] = means.try_emplace({part.material, part.kind});
            if (is_new)
                mean->second = glm::max(mean_base_color(tree, part.material, part.kind), glm::vec3(1e-4f));
            for (std::size_t t = 0; t < part.triangles.size(); ++t)
                base_[patch_number(tree, part, t)] = mean->second;
        }
        scale_ = shaded.scale > 0 ? shaded.scale : percentile_99();
    }

    float scale() const { return scale_; }

    /// Of both sides of a leaf, or the front of bark.
    glm::vec3 of(std::size_t patch) const { return color(unscaled(patch), patch); }
    glm::vec3 of_side(std::size_t patch, bool back) const {
        return color(back ? shaded_.radiance_back[patch] : shaded_.radiance_front[patch], patch);
    }

  private:
    glm::vec3 unscaled(std::size_t patch) const {
        return patch < tree_.leaves.size() ? 0.5f * (shaded_.radiance_front[patch] + shaded_.radiance_back[patch])
                                           : shaded_.radiance_front[patch];
    }
    glm::vec3 color(const glm::vec3& radiance, std::size_t patch) const {
        return glm::clamp(radiance / base_[patch] / scale_, 0.f, 1.f);
    }
    float percentile_99() const {
        std::vector<float> values;
        for (std::size_t patch = 0; patch < base_.size(); ++patch) {
            const glm::vec3 value = unscaled(patch) / base_[patch];
            values.insert(values.end(), {value.r, value.g, value.b});
        }
        if (values.empty())
            return 1.f;
        const std::size_t at = std::min(values.size() - 1, values.size() * 99 / 100);
        std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(at), values.end());
        const float value = values[at];
        return value > 0 && std::isfinite(value) ? std::max(value, 1e-30f) : 1.f;
    }

    const Tree& tree_;
    const ShadedAttributes& shaded_;
    std::vector<glm::vec3> base_;
    float scale_ = 1;
};

/// Colour and alpha in one image; the smaller one is enlarged to the nearest texel.
Image combined_texture(const TreeMaterial& material) {
    const Image* color = material.base_color_texture && !material.base_color_texture->empty()
                             ? material.base_color_texture.get()
                             : nullptr;
    const Image* alpha =
        material.alpha_texture && !material.alpha_texture->empty() ? material.alpha_texture.get() : nullptr;
    if (!alpha)
        return color ? *color : Image();
    const int width = std::max(color ? color->width : 0, alpha->width),
              height = std::max(color ? color->height : 0, alpha->height);
    Image result(width, height, 4);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            float* pixel = result.at(x, y);
            const auto nearest = [&](const Image& image) {
                return image.at(int(std::int64_t(x) * image.width / width),
                                int(std::int64_t(y) * image.height / height));
            };
            for (int c = 0; c < 3; ++c)
                pixel[c] = color ? nearest(*color)[color->channels == 3 ? c : 0] : 1.f;
            pixel[3] = nearest(*alpha)[0];
        }
    return result;
}

class TreeWriter {
  public:
    TreeWriter(const Tree& tree, const ShadedAttributes* shaded, const WriteOptions& options)
        : tree_(tree), shaded_(shaded), split_(options.split_sides) {
        if (shaded)
            colors_.emplace(tree, *shaded);
    }

    void save(const std::filesystem::path& path, Progress& progress) {
        progress.begin("writing glTF", tree_.parts.size() + 1);
        for (std::size_t m = 0; m < tree_.materials.size(); ++m) {
            add_material(tree_.materials[m]);
            progress.throw_if_stopped();
        }
        std::vector<PartPlace> places;
        for (const TreePart& part : tree_.parts) {
            places.push_back(add_part(part));
            progress.throw_if_stopped();
            progress.advance(1);
        }
        add_scene();
        nlohmann::json extras;
        extras["kokage"] = write_extras(writer_, tree_, places, shaded_, colors_ ? colors_->scale() : 0.f);
        writer_.set_extras(extras);
        writer_.save(path);
        progress.advance(1);
    }

  private:
    static int wrap(TextureWrap mode) {
        return mode == TextureWrap::clamp    ? TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE
               : mode == TextureWrap::mirror ? TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT
                                             : TINYGLTF_TEXTURE_WRAP_REPEAT;
    }

    int add_texture(const TreeMaterial& material) {
        const auto key = std::make_pair(material.base_color_texture.get(), material.alpha_texture.get());
        const auto [image, is_new] = images_.try_emplace(key, 0);
        if (is_new)
            image->second = writer_.add_png(encode_png(combined_texture(material)), material.name);
        tinygltf::Sampler sampler;
        sampler.wrapS = wrap(material.wrap_u);
        sampler.wrapT = wrap(material.wrap_v);
        sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
        sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
        tinygltf::Model& model = writer_.model();
        model.samplers.push_back(sampler);
        tinygltf::Texture texture;
        texture.source = image->second;
        texture.sampler = int(model.samplers.size()) - 1;
        model.textures.push_back(texture);
        return int(model.textures.size()) - 1;
    }

    void add_material(const TreeMaterial& source) {
        tinygltf::Material material;
        material.name = valid_utf8(source.name);
        auto& pbr = material.pbrMetallicRoughness;
        pbr.baseColorFactor = {source.base_color.r, source.base_color.g, source.base_color.b, 1.0};
        pbr.metallicFactor = 0;
        pbr.roughnessFactor = source.roughness;
        const bool has_alpha = source.alpha_texture && !source.alpha_texture->empty();
        if (has_alpha || (source.base_color_texture && !source.base_color_texture->empty()))
            pbr.baseColorTexture.index = add_texture(source);
        material.alphaMode = has_alpha ? "MASK" : "OPAQUE";
        if (has_alpha)
            material.alphaCutoff = source.alpha_cutoff;
        material.doubleSided = source.double_sided;
        // Beside KHR_materials_unlit viewers would ignore it, and the validator warns: shaded files keep it in extras
        // alone.
        if (source.diffuse_transmission >= 0 && !shaded_) {
            tinygltf::Value::Object transmission;
            transmission["diffuseTransmissionFactor"] = tinygltf::Value(double(source.diffuse_transmission));
            const glm::vec3& color = source.diffuse_transmission_color;
            transmission["diffuseTransmissionColorFactor"] = tinygltf::Value(tinygltf::Value::Array{
                tinygltf::Value(double(color.r)), tinygltf::Value(double(color.g)), tinygltf::Value(double(color.b))});
            material.extensions["KHR_materials_diffuse_transmission"] = tinygltf::Value(transmission);
            writer_.use_extension("KHR_materials_diffuse_transmission");
        }
        if (shaded_) {
            material.extensions["KHR_materials_unlit"] = tinygltf::Value(tinygltf::Value::Object());
            writer_.use_extension("KHR_materials_unlit");
        }
        writer_.model().materials.push_back(std::move(material));
    }

    /// A material for sheets of one side: as the given one, back faces culled.
    int single_sided(std::uint32_t material) {
        const auto [found, is_new] = single_sided_.try_emplace(material, -1);
        if (is_new) {
            tinygltf::Model& model = writer_.model();
            model.materials.push_back(model.materials[material]);
            model.materials.back().doubleSided = false;
            found->second = int(model.materials.size()) - 1;
        }
        return found->second;
    }

    /// A part's vertices with one patch each: a vertex that several patches share is repeated for the later ones.
    struct SplitMesh {
        std::vector<glm::uvec3> triangles;
        std::vector<std::uint32_t> source;     ///< part's vertex of each written vertex
        std::vector<std::size_t> vertex_patch; ///< ~0 for vertices without triangles
    };

    SplitMesh split_by_patch(const TreePart& part) const {
        SplitMesh mesh;
        mesh.triangles = part.triangles;
        mesh.source.resize(part.positions.size());
        for (std::size_t v = 0; v < mesh.source.size(); ++v)
            mesh.source[v] = std::uint32_t(v);
        mesh.vertex_patch.assign(part.positions.size(), ~std::size_t(0));
        if (!shaded_)
            return mesh;
        std::map<std::pair<std::uint32_t, std::size_t>, std::uint32_t> copies;
        for (std::size_t t = 0; t < part.triangles.size(); ++t) {
            const std::size_t patch = patch_number(tree_, part, t);
            for (std::size_t c = 0; c < 3; ++c) {
                const std::uint32_t vertex = part.triangles[t][c];
                if (mesh.vertex_patch[vertex] == ~std::size_t(0))
                    mesh.vertex_patch[vertex] = patch;
                if (mesh.vertex_patch[vertex] == patch)
                    continue;
                const auto [copy, is_new] = copies.try_emplace({vertex, patch}, std::uint32_t(mesh.source.size()));
                if (is_new) {
                    mesh.source.push_back(vertex);
                    mesh.vertex_patch.push_back(patch);
                }
                mesh.triangles[t][c] = copy->second;
            }
        }
        return mesh;
    }

    template <typename Value>
    static std::vector<Value> gather(const std::vector<Value>& values, const std::vector<std::uint32_t>& source) {
        std::vector<Value> result(source.size());
        for (std::size_t i = 0; i < source.size(); ++i)
            result[i] = values[source[i]];
        return result;
    }

    /// A value of each vertex's patch; 0 for vertices without triangles.
    template <typename Function>
    static std::vector<glm::vec3> per_vertex(const SplitMesh& mesh, const Function& value) {
        std::vector<glm::vec3> result(mesh.vertex_patch.size(), glm::vec3(0.f));
        for (std::size_t v = 0; v < result.size(); ++v)
            if (mesh.vertex_patch[v] != ~std::size_t(0))
                result[v] = value(mesh.vertex_patch[v]);
        return result;
    }

    void add_vectors(tinygltf::Primitive& primitive, const std::string& name, const std::vector<glm::vec3>& values) {
        primitive.attributes[name] = writer_.add(values, GltfArrayUse::vertices, name);
    }

    /// The solved light on a primitive. `swapped`: the sheet of a leaf's back, which is its own front.
    void add_light(tinygltf::Primitive& primitive, const SplitMesh& mesh, TreePartKind kind, bool swapped) {
        const auto attribute = [&](const std::string& name, const std::vector<glm::vec3>& values) {
            if (!values.empty())
                add_vectors(primitive, name, per_vertex(mesh, [&](std::size_t patch) { return values[patch]; }));
        };
        if (kind == TreePartKind::bark) {
            attribute("_RADIANCE", shaded_->radiance_front);
            attribute("_INDIRECT", shaded_->indirect_front);
        } else {
            attribute("_RADIANCE_FRONT", swapped ? shaded_->radiance_back : shaded_->radiance_front);
            attribute("_RADIANCE_BACK", swapped ? shaded_->radiance_front : shaded_->radiance_back);
            attribute("_INDIRECT_FRONT", swapped ? shaded_->indirect_back : shaded_->indirect_front);
            attribute("_INDIRECT_BACK", swapped ? shaded_->indirect_front : shaded_->indirect_back);
        }
        const bool own_side = split_ && kind == TreePartKind::foliage;
        add_vectors(primitive, "COLOR_0", per_vertex(mesh, [&](std::size_t patch) {
                        return own_side ? colors_->of_side(patch, swapped) : colors_->of(patch);
                    }));
    }

    PartPlace add_part(const TreePart& part) {
        PartPlace place;
        if (part.triangles.empty())
            return place;
        const SplitMesh mesh = split_by_patch(part);
        place.mesh = 0;
        place.primitive = int(primitives_.size());
        place.duplicate_of.assign(mesh.source.begin() + std::ptrdiff_t(part.positions.size()), mesh.source.end());

        tinygltf::Primitive primitive;
        primitive.mode = TINYGLTF_MODE_TRIANGLES;
        primitive.material = int(part.material);
        primitive.attributes["POSITION"] =
            writer_.add(gather(part.positions, mesh.source), GltfArrayUse::positions, "position");
        std::vector<glm::vec3> normals = gather(part.normals, mesh.source);
        for (glm::vec3& normal : normals) { // glTF allows unit vectors alone
            const float length = glm::length(normal);
            if (!(std::abs(length - 1.f) < 1e-4f))
                normal = length > 0 && std::isfinite(length) ? normal / length : glm::vec3(0, 1, 0);
        }
        add_vectors(primitive, "NORMAL", normals);
        if (!part.uvs.empty())
            primitive.attributes["TEXCOORD_0"] = writer_.add(std::span<const glm::vec2>(gather(part.uvs, mesh.source)),
                                                             GltfArrayUse::vertices, "texture coordinate");
        primitive.indices = add_triangles(mesh.triangles);
        const bool sheets = split_ && part.kind == TreePartKind::foliage;
        tinygltf::Primitive back = primitive;
        if (shaded_)
            add_light(primitive, mesh, part.kind, false);
        if (sheets)
            primitive.material = single_sided(part.material);
        primitives_.push_back(std::move(primitive));
        if (sheets)
            add_back_sheet(std::move(back), mesh, std::move(normals), part);
        return place;
    }

    int add_triangles(const std::vector<glm::uvec3>& triangles) {
        return writer_.add(std::span(reinterpret_cast<const std::uint32_t*>(triangles.data()), triangles.size() * 3),
                           GltfArrayUse::indices, "triangle corner");
    }

    void add_back_sheet(tinygltf::Primitive primitive, const SplitMesh& mesh, std::vector<glm::vec3> normals,
                        const TreePart& part) {
        for (glm::vec3& normal : normals)
            normal = -normal;
        add_vectors(primitive, "NORMAL", normals);
        std::vector<glm::uvec3> triangles = mesh.triangles;
        for (glm::uvec3& triangle : triangles)
            std::swap(triangle.y, triangle.z);
        primitive.indices = add_triangles(triangles);
        primitive.material = single_sided(part.material);
        if (shaded_)
            add_light(primitive, mesh, part.kind, true);
        primitives_.push_back(std::move(primitive));
    }

    void add_scene() {
        tinygltf::Model& model = writer_.model();
        tinygltf::Scene scene;
        tinygltf::Node node;
        node.name = valid_utf8(tree_.name);
        if (!primitives_.empty()) {
            tinygltf::Mesh mesh;
            mesh.name = node.name;
            mesh.primitives = std::move(primitives_);
            model.meshes.push_back(std::move(mesh));
            node.mesh = 0;
        }
        if (tree_.origin != glm::dvec3(0.0))
            node.translation = {tree_.origin.x, tree_.origin.y, tree_.origin.z};
        model.nodes.push_back(std::move(node));
        scene.nodes.push_back(0);
        model.scenes.push_back(std::move(scene));
        model.defaultScene = 0;
    }

    const Tree& tree_;
    const ShadedAttributes* shaded_;
    bool split_;
    std::optional<ShadingColors> colors_;
    GltfWriter writer_;
    std::vector<tinygltf::Primitive> primitives_;
    std::map<std::pair<const Image*, const Image*>, int> images_;
    std::map<std::uint32_t, int> single_sided_;
};

} // namespace

void write_tree(const std::filesystem::path& path, const Tree& tree, const ShadedAttributes* shaded,
                const WriteOptions& options, Progress& progress) {
    check_tree(tree, shaded);
    TreeWriter(tree, shaded, options).save(path, progress);
}

ShadedAttributes read_shaded(const std::filesystem::path& path, Progress& progress) {
    const GltfDocument document = GltfDocument::read(path, progress);
    std::string why = "it was not written by Kokage";
    std::optional<OwnTree> own = read_own_tree(document, why, progress);
    if (own && !own->shaded)
        why = "it is a tree that was not shaded";
    if (!own || !own->shaded)
        throw InputError(path.string() + ": is not a shaded tree: " + why);
    ShadedAttributes result;
    result.scale = own->scale;
    result.light_maps = std::move(own->light_maps);
    const Tree& tree = own->tree;
    const std::size_t patches = tree.leaves.size() + tree.bark_patch_count;
    result.radiance_front.assign(patches, glm::vec3(0.f));
    result.radiance_back.assign(patches, glm::vec3(0.f));
    for (std::size_t p = 0; p < tree.parts.size(); ++p) {
        const TreePart& part = tree.parts[p];
        const PartPlace& place = own->places[p];
        if (place.mesh < 0)
            continue;
        const std::vector<std::uint32_t> corners = document.unsigned_integers(
            document.model().meshes[std::size_t(place.mesh)].primitives[std::size_t(place.primitive)].indices);
        const auto take = [&](const std::string& name, std::vector<glm::vec3>& into) {
            const auto found = own->attributes[p].find(name);
            if (found == own->attributes[p].end())
                return;
            const std::vector<float> values = document.floats(found->second, 3);
            into.resize(patches, glm::vec3(0.f));
            for (std::size_t t = 0; t < part.triangles.size(); ++t) {
                const std::size_t v = corners[3 * t];
                into[patch_number(tree, part, t)] = {values[3 * v], values[3 * v + 1], values[3 * v + 2]};
            }
        };
        const bool leaf = part.kind == TreePartKind::foliage;
        take(leaf ? "_RADIANCE_FRONT" : "_RADIANCE", result.radiance_front);
        take(leaf ? "_INDIRECT_FRONT" : "_INDIRECT", result.indirect_front);
        take("_RADIANCE_BACK", result.radiance_back);
        take("_INDIRECT_BACK", result.indirect_back);
    }
    if (!result.indirect_front.empty())
        result.indirect_back.resize(patches, glm::vec3(0.f));
    return result;
}

} // namespace kokage
