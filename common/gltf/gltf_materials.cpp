#include "common/gltf/gltf_materials.h"

#include "common/scene/image_file.h"
#include "common/services/error.h"

#include <algorithm>
#include <cmath>
#include <tiny_gltf.h>

namespace kokage {
namespace {

struct DecodedImage {
    std::shared_ptr<const Image> color, alpha;
};

/// Splits RGB and alpha; alpha that is 1 everywhere is no alpha.
DecodedImage split_alpha(const Image& image) {
    const std::size_t count = std::size_t(image.width) * std::size_t(image.height);
    const std::size_t channels = std::size_t(image.channels);
    auto color = std::make_shared<Image>(image.width, image.height, 3);
    const bool grey = channels <= 2, has_alpha = channels == 2 || channels == 4;
    std::shared_ptr<Image> alpha = has_alpha ? std::make_shared<Image>(image.width, image.height, 1) : nullptr;
    bool opaque = true;
    for (std::size_t i = 0; i < count; ++i) {
        const float* from = image.pixels.data() + i * channels;
        for (std::size_t c = 0; c < 3; ++c)
            color->pixels[i * 3 + c] = from[grey ? 0 : c];
        if (alpha) {
            alpha->pixels[i] = from[channels - 1];
            opaque = opaque && from[channels - 1] >= 1.f;
        }
    }
    return {color, opaque ? nullptr : alpha};
}

class MaterialReader {
  public:
    explicit MaterialReader(const GltfDocument& document)
        : document_(document), images_(document.model().images.size()) {}

    GltfMaterial read(const tinygltf::Material& source, std::size_t index) {
        GltfMaterial material;
        material.name = source.name;
        const std::string place =
            "material " + std::to_string(index) + (source.name.empty() ? "" : " '" + source.name + "'");
        const auto& pbr = source.pbrMetallicRoughness;
        const tinygltf::Value* diffuse = extension(source, "KHR_materials_pbrSpecularGlossiness");
        if (diffuse) {
            material.base_color = color4(diffuse->Get("diffuseFactor"), glm::vec4(1.f));
            if (diffuse->Has("diffuseTexture"))
                material.base_color_texture = texture_from(diffuse->Get("diffuseTexture"), place);
        } else {
            for (std::size_t c = 0; c < 4 && c < pbr.baseColorFactor.size(); ++c)
                material.base_color[c] = float(pbr.baseColorFactor[c]);
            if (pbr.baseColorTexture.index >= 0)
                material.base_color_texture = texture(pbr.baseColorTexture.index, pbr.baseColorTexture.texCoord,
                                                      pbr.baseColorTexture.extensions, place);
        }
        for (std::size_t c = 0; c < 4; ++c)
            if (!std::isfinite(material.base_color[c]))
                document_.fail(place + ": its base colour is not finite");
        material.base_color = glm::clamp(material.base_color, 0.f, 1.f);
        material.alpha_mode = source.alphaMode == "MASK"    ? GltfAlphaMode::mask
                              : source.alphaMode == "BLEND" ? GltfAlphaMode::blend
                                                            : GltfAlphaMode::opaque;
        material.alpha_cutoff = float(source.alphaCutoff);
        material.double_sided = source.doubleSided;
        material.unlit = extension(source, "KHR_materials_unlit") != nullptr;
        material.roughness = float(pbr.roughnessFactor);
        if (const tinygltf::Value* diffuse_transmission = extension(source, "KHR_materials_diffuse_transmission")) {
            material.diffuse_transmission = number(diffuse_transmission->Get("diffuseTransmissionFactor"), 0.f);
            material.diffuse_transmission_color =
                glm::vec3(color4(diffuse_transmission->Get("diffuseTransmissionColorFactor"), glm::vec4(1.f)));
        }
        if (const tinygltf::Value* transmission = extension(source, "KHR_materials_transmission"))
            material.transmission = number(transmission->Get("transmissionFactor"), 0.f);
        return material;
    }

  private:
    const tinygltf::Value* extension(const tinygltf::Material& source, const std::string& name) const {
        const auto found = source.extensions.find(name);
        return found == source.extensions.end() ? nullptr : &found->second;
    }

    static float number(const tinygltf::Value& value, float missing) {
        return value.IsNumber() ? float(value.GetNumberAsDouble()) : missing;
    }

    static glm::vec4 color4(const tinygltf::Value& value, glm::vec4 missing) {
        if (value.IsArray())
            for (std::size_t c = 0; c < 4 && c < value.ArrayLen(); ++c)
                missing[c] = number(value.Get(int(c)), missing[c]);
        return missing;
    }

    GltfTexture texture_from(const tinygltf::Value& info, const std::string& place) {
        tinygltf::ExtensionMap extensions;
        if (info.Has("extensions") && info.Get("extensions").IsObject())
            extensions = info.Get("extensions").Get<tinygltf::Value::Object>();
        return texture(int(number(info.Get("index"), -1.f)), int(number(info.Get("texCoord"), 0.f)), extensions, place);
    }

    GltfTexture texture(int index, int texture_coordinates, const tinygltf::ExtensionMap& extensions,
                        const std::string& place) {
        const tinygltf::Model& model = document_.model();
        if (index < 0 || std::size_t(index) >= model.textures.size())
            document_.fail(place + ": texture " + std::to_string(index) + " does not exist");
        const tinygltf::Texture& source = model.textures[std::size_t(index)];
        GltfTexture result;
        result.texture_coordinates = texture_coordinates;
        int image = source.source;
        if (const auto webp = source.extensions.find("EXT_texture_webp"); webp != source.extensions.end())
            image = int(number(webp->second.Get("source"), float(image)));
        const DecodedImage& decoded = decode(image, place);
        result.color = decoded.color;
        result.alpha = decoded.alpha;
        if (source.sampler >= 0 && std::size_t(source.sampler) < model.samplers.size()) {
            result.wrap_u = wrap(model.samplers[std::size_t(source.sampler)].wrapS);
            result.wrap_v = wrap(model.samplers[std::size_t(source.sampler)].wrapT);
        }
        if (const auto transform = extensions.find("KHR_texture_transform"); transform != extensions.end()) {
            const tinygltf::Value& value = transform->second;
            result.offset = glm::vec2(color4(value.Get("offset"), glm::vec4(0.f)));
            result.scale = glm::vec2(color4(value.Get("scale"), glm::vec4(1.f)));
            result.rotation = number(value.Get("rotation"), 0.f);
            result.texture_coordinates = int(number(value.Get("texCoord"), float(texture_coordinates)));
        }
        return result;
    }

    static TextureWrap wrap(int mode) {
        return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? TextureWrap::clamp
               : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? TextureWrap::mirror
                                                               : TextureWrap::repeat;
    }

    const DecodedImage& decode(int index, const std::string& place) {
        const std::span<const unsigned char> bytes = document_.image_bytes(index); // throws if there is no such image
        DecodedImage& decoded = images_[std::size_t(index)];
        if (!decoded.color) {
            ImageLoading loading;
            loading.max_pixels = std::uint64_t(1) << 27;
            decoded = split_alpha(load_image(
                std::as_bytes(bytes), document_.path() + ", image " + std::to_string(index) + " of " + place, loading));
        }
        return decoded;
    }

    const GltfDocument& document_;
    std::vector<DecodedImage> images_;
};

} // namespace

std::vector<GltfMaterial> read_gltf_materials(const GltfDocument& document, Progress& progress) {
    std::vector<GltfMaterial> materials;
    MaterialReader reader(document);
    for (const tinygltf::Material& source : document.model().materials) {
        progress.throw_if_stopped();
        materials.push_back(reader.read(source, materials.size()));
    }
    materials.emplace_back().name = "default";
    return materials;
}

} // namespace kokage
