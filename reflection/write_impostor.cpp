// Impostors as glTF (declared in reflection/impostor.h).
#include "common/gltf/gltf_writer.h"
#include "common/scene/image_file.h"
#include "reflection/impostor.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

namespace kokage {
namespace {

/// Radiance / scale with the alpha beside it.
Image stored_color(const Impostor& impostor) {
    Image image(impostor.color.width, impostor.color.height, 4);
    for (std::size_t i = 0; i < impostor.alpha.pixels.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            image.pixels[4 * i + c] = std::clamp(impostor.color.pixels[3 * i + c] / impostor.scale, 0.f, 1.f);
        image.pixels[4 * i + 3] = impostor.alpha.pixels[i];
    }
    return image;
}

Image stored_normal(const Impostor& impostor) {
    Image image = impostor.normal;
    for (float& value : image.pixels)
        value = 0.5f + 0.5f * value;
    return image;
}

int add_texture(tinygltf::Model& model, int image) {
    tinygltf::Sampler sampler;
    sampler.wrapS = sampler.wrapT = TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
    sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
    model.samplers.push_back(sampler);
    tinygltf::Texture texture;
    texture.source = image;
    texture.sampler = int(model.samplers.size()) - 1;
    model.textures.push_back(texture);
    return int(model.textures.size()) - 1;
}

} // namespace

void write_impostor(const std::filesystem::path& path, const Impostor& impostor, const std::string& name) {
    GltfWriter writer;
    tinygltf::Model& model = writer.model();
    tinygltf::Material material;
    material.name = valid_utf8(name + " impostor");
    const int color = writer.add_png(encode_png(stored_color(impostor)), "radiance");
    const int normal =
        writer.add_png(encode_png(stored_normal(impostor), {.png_encoding = PngEncoding::as_is}), "normal");
    material.pbrMetallicRoughness.baseColorTexture.index = add_texture(model, color);
    material.pbrMetallicRoughness.metallicFactor = 0;
    material.normalTexture.index = add_texture(model, normal);
    material.alphaMode = "MASK";
    material.alphaCutoff = impostor.alpha_cutoff;
    material.extensions["KHR_materials_unlit"] = tinygltf::Value(tinygltf::Value::Object());
    writer.use_extension("KHR_materials_unlit");
    model.materials.push_back(material);

    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec2> uvs;
    std::vector<glm::vec4> tangents;
    std::vector<std::uint32_t> indices;
    std::vector<float> azimuths;
    const std::size_t rows = impostor.faces.size() / 2;
    for (std::size_t f = 0; f < impostor.faces.size(); ++f) {
        const ViewFrame& face = impostor.faces[f];
        const std::uint32_t first = std::uint32_t(positions.size());
        const glm::vec3 right = face.right(), up(0, 1, 0);
        const float u = 0.5f * float(f % 2), v = float(f / 2) / float(rows), height = 1 / float(rows);
        for (const glm::vec2& corner : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
            positions.push_back(face.centre + corner.x * face.half_width * right + corner.y * face.half_height * up);
            normals.push_back(face.towards_viewer);
            tangents.push_back({right, 1.f});
            uvs.push_back({u + (corner.x > 0 ? 0.5f : 0.f), v + (corner.y > 0 ? 0.f : height)});
        }
        for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u})
            indices.push_back(first + k);
        azimuths.push_back(std::atan2(face.towards_viewer.x, face.towards_viewer.z));
    }
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = 0;
    primitive.attributes["POSITION"] = writer.add(positions, GltfArrayUse::positions, "position");
    primitive.attributes["NORMAL"] = writer.add(normals, GltfArrayUse::vertices, "normal");
    primitive.attributes["TANGENT"] = writer.add(tangents, GltfArrayUse::vertices, "tangent");
    primitive.attributes["TEXCOORD_0"] = writer.add(uvs, GltfArrayUse::vertices, "texture coordinate");
    primitive.indices = writer.add(indices, GltfArrayUse::indices, "corner");
    tinygltf::Mesh mesh;
    mesh.name = valid_utf8(name);
    mesh.primitives.push_back(std::move(primitive));
    model.meshes.push_back(std::move(mesh));
    tinygltf::Node node;
    node.mesh = 0;
    node.name = valid_utf8(name);
    model.nodes.push_back(std::move(node));
    tinygltf::Scene scene;
    scene.nodes.push_back(0);
    model.scenes.push_back(std::move(scene));
    model.defaultScene = 0;
    writer.set_extras({{"kokage_impostor", {{"scale", impostor.scale}, {"azimuths", azimuths}}}});
    writer.save(path);
}

} // namespace kokage
