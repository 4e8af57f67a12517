#include "common/gltf/gltf_materials.h"

#include "common/gltf/gltf_scene.h"
#include "common/gltf/gltf_values.h"
#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "common/services/named_file.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace kokage {
namespace {

/// Of all colour textures of a file together, and of one.
constexpr std::uint64_t kMaximumPixels = std::uint64_t(1) << 27;
constexpr std::uint64_t kMaximumPixelsOfOne = std::uint64_t(1) << 26;

/// A texture's image in a format that nothing here decodes.
struct LostImage {
    std::string what; ///< "in KTX2 (BasisU), which can't be decoded"
};

class MaterialReader {
  public:
    MaterialReader(const GltfDocument& document, std::vector<std::string>& notes,
                   PixelMeaning meaning = PixelMeaning::color)
        : document_(document), notes_(notes), meaning_(meaning), images_(document.image_count()) {}

    SceneMaterial read(const tinygltf::Material& source, std::size_t index) {
        SceneMaterial material;
        material.name = source.name;
        const std::string place = place_of(source, index);
        const auto& pbr = source.pbrMetallicRoughness;
        material.alpha_mode = source.alphaMode == "MASK"    ? AlphaMode::mask
                              : source.alphaMode == "BLEND" ? AlphaMode::blend
                                                            : AlphaMode::opaque;
        material.alpha_cutoff = glm::clamp(float(source.alphaCutoff), 0.f, 2.f);
        material.double_sided = source.doubleSided;
        material.unlit = extension(source, "KHR_materials_unlit") != nullptr;
        material.roughness = factor(pbr.roughnessFactor, 0, 1);
        if (const tinygltf::Value* ior = extension(source, "KHR_materials_ior"))
            material.index_of_refraction = glm::clamp(number(member(*ior, "ior"), 1.5f), 0.f, 100.f);
        const tinygltf::Value* diffuse = extension(source, "KHR_materials_pbrSpecularGlossiness");
        if (diffuse) {
            material.base_color = color4(member(*diffuse, "diffuseFactor"), glm::vec4(1.f));
            if (diffuse->Has("diffuseTexture"))
                read_color_texture(material, texture_info(member(*diffuse, "diffuseTexture")), place);
        } else {
            material.metallic = factor(pbr.metallicFactor, 0, 1);
            for (std::size_t c = 0; c < 4 && c < pbr.baseColorFactor.size(); ++c)
                material.base_color[c] = float(pbr.baseColorFactor[c]);
            if (pbr.baseColorTexture.index >= 0)
                read_color_texture(
                    material,
                    {pbr.baseColorTexture.index, pbr.baseColorTexture.texCoord, pbr.baseColorTexture.extensions},
                    place);
        }
        for (std::size_t c = 0; c < 4; ++c)
            if (!std::isfinite(material.base_color[c]))
                document_.fail(place + ": its base colour is not finite");
        material.base_color = glm::clamp(material.base_color, 0.f, 1.f);
        if (const tinygltf::Value* transmitted = extension(source, "KHR_materials_diffuse_transmission"))
            read_diffuse_transmission(material, *transmitted, place);
        if (const tinygltf::Value* transmission = extension(source, "KHR_materials_transmission"))
            material.transmission = glm::clamp(number(member(*transmission, "transmissionFactor"), 0.f), 0.f, 1.f);
        return material;
    }

    /// Of a material that was read.
    void read_gloss_texture(const tinygltf::Material& source, SceneMaterial& material, std::size_t index) {
        const auto& info = source.pbrMetallicRoughness.metallicRoughnessTexture;
        if (info.index < 0)
            return;
        const std::string place = place_of(source, index);
        try {
            material.roughness_metallic_texture = texture({info.index, info.texCoord, info.extensions}, place);
        } catch (const LostImage& lost) {
            notes_.push_back(place + ": its texture of roughness and metal is " + lost.what +
                             ": its factors alone were read");
        }
    }

    /// Of a material that was read.
    void read_normal_texture(const tinygltf::Material& source, SceneMaterial& material, std::size_t index) {
        const auto& info = source.normalTexture;
        if (info.index < 0 || material.alpha_mode != AlphaMode::opaque)
            return;
        const std::string place = place_of(source, index);
        try {
            material.normal_texture = texture({info.index, info.texCoord, info.extensions}, place);
            material.normal_scale = std::isfinite(info.scale) ? float(std::clamp(info.scale, -1e3, 1e3)) : 1.f;
        } catch (const LostImage& lost) {
            notes_.push_back(place + ": its texture of normals is " + lost.what + ": it is even");
        }
    }

  private:
    static std::string place_of(const tinygltf::Material& source, std::size_t index) {
        return "material " + std::to_string(index) + (source.name.empty() ? "" : " '" + shown_name(source.name) + "'");
    }

    static float factor(double value, double low, double high) {
        return std::isfinite(value) ? float(std::clamp(value, low, high)) : float(high);
    }

    struct TextureInfo {
        int index = -1, texture_coordinates = 0;
        tinygltf::ExtensionMap extensions;
    };

    void read_color_texture(SceneMaterial& material, const TextureInfo& info, const std::string& place) {
        try {
            material.base_color_texture = texture(info, place);
        } catch (const LostImage& lost) {
            if (material.alpha_mode != AlphaMode::opaque)
                document_.fail(place + ": its alpha mask is " + lost.what +
                               ", and without it every leaf would be a solid card; export its textures as PNG, JPEG or "
                               "WebP");
            material.color_is_lost = true;
            notes_.push_back(place + ": its colour texture is " + lost.what +
                             ": a plain colour stands in for it; export its textures as PNG, JPEG or WebP");
        }
    }

    /// Factors times the means of their textures: a leaf has one transmittance here.
    void read_diffuse_transmission(SceneMaterial& material, const tinygltf::Value& source, const std::string& place) {
        float factor = number(member(source, "diffuseTransmissionFactor"), 0.f);
        glm::vec3 color(color4(member(source, "diffuseTransmissionColorFactor"), glm::vec4(1.f)));
        const Image* mask = material.base_color_texture && material.base_color_texture->alpha
                                ? material.base_color_texture->alpha.get()
                                : nullptr;
        for (const char* name : {"diffuseTransmissionTexture", "diffuseTransmissionColorTexture"}) {
            if (!source.Has(name))
                continue;
            try {
                const SceneTexture read = texture(texture_info(member(source, name)), place);
                if (name == std::string_view("diffuseTransmissionTexture"))
                    factor *= read.alpha ? mean(*read.alpha, mask, material.alpha_cutoff).r : 1.f;
                else
                    color *= mean(*read.color, mask, material.alpha_cutoff);
                notes_.push_back(place + ": its " + name + " is taken as its mean");
            } catch (const LostImage& lost) {
                notes_.push_back(place + ": its " + name + " is " + lost.what + ": its factor alone was read");
            }
        }
        if (!std::isfinite(factor) || !std::isfinite(color.r + color.g + color.b))
            document_.fail(place + ": its diffuse transmission is not finite");
        material.diffuse_transmission = glm::clamp(factor, 0.f, 1.f);
        material.diffuse_transmission_color = glm::clamp(color, 0.f, 1.f);
    }

    /// The mean of an image, where the mask is solid if there is one of the same size.
    static glm::vec3 mean(const Image& image, const Image* mask, float cutoff) {
        const bool masked = mask && mask->width == image.width && mask->height == image.height;
        const auto channels = std::size_t(image.channels);
        glm::dvec3 sum(0.0);
        double count = 0;
        for (std::size_t i = 0; i < image.pixels.size() / channels; ++i) {
            if (masked && mask->pixels[i] < cutoff)
                continue;
            for (std::size_t c = 0; c < 3; ++c)
                sum[c] += double(image.pixels[i * channels + std::min(c, channels - 1)]);
            count += 1;
        }
        return count > 0 ? glm::vec3(sum / count) : glm::vec3(0.f);
    }

    const tinygltf::Value* extension(const tinygltf::Material& source, const std::string& name) const {
        const auto found = source.extensions.find(name);
        return found == source.extensions.end() ? nullptr : &found->second;
    }

    static float number(const tinygltf::Value& value, float missing) {
        return value.IsNumber() ? float(value.GetNumberAsDouble()) : missing;
    }

    static int integer(const tinygltf::Value& value, int missing) {
        const double found = value.IsNumber() ? value.GetNumberAsDouble() : missing;
        return std::abs(found) < 1e9 ? int(found) : -1;
    }

    static glm::vec4 color4(const tinygltf::Value& value, glm::vec4 missing) {
        if (value.IsArray())
            for (std::size_t c = 0; c < 4 && c < value.ArrayLen(); ++c)
                missing[c] = number(value.Get(int(c)), missing[c]);
        return missing;
    }

    static TextureInfo texture_info(const tinygltf::Value& info) {
        TextureInfo result{integer(member(info, "index"), -1), integer(member(info, "texCoord"), 0), {}};
        if (info.Has("extensions") && member(info, "extensions").IsObject())
            result.extensions = member(info, "extensions").Get<tinygltf::Value::Object>();
        return result;
    }

    /// Throws LostImage.
    SceneTexture texture(const TextureInfo& info, const std::string& place) {
        const tinygltf::Model& model = document_.model();
        if (info.index < 0 || std::size_t(info.index) >= model.textures.size())
            document_.fail(place + ": texture " + std::to_string(info.index) + " does not exist");
        const tinygltf::Texture& source = model.textures[std::size_t(info.index)];
        SceneTexture result = decode(image_of(source), place);
        result.texture_coordinates = info.texture_coordinates;
        if (source.sampler >= 0 && std::size_t(source.sampler) < model.samplers.size()) {
            result.wrap_u = wrap(model.samplers[std::size_t(source.sampler)].wrapS);
            result.wrap_v = wrap(model.samplers[std::size_t(source.sampler)].wrapT);
        }
        if (const auto transform = info.extensions.find("KHR_texture_transform"); transform != info.extensions.end()) {
            const tinygltf::Value& value = transform->second;
            result.offset = glm::vec2(color4(member(value, "offset"), glm::vec4(0.f)));
            result.scale = glm::vec2(color4(member(value, "scale"), glm::vec4(1.f)));
            result.rotation = number(member(value, "rotation"), 0.f);
            result.texture_coordinates = integer(member(value, "texCoord"), info.texture_coordinates);
            if (!std::isfinite(result.offset.x + result.offset.y + result.scale.x + result.scale.y + result.rotation))
                document_.fail(place + ": its texture's transform is not finite");
        }
        return result;
    }

    /// WebP before the fallback that files give beside it; formats that can't be decoded only where there is no other.
    static int image_of(const tinygltf::Texture& source) {
        const auto named = [&](const char* name) {
            const auto found = source.extensions.find(name);
            return found == source.extensions.end() ? -1 : integer(member(found->second, "source"), -1);
        };
        if (const int webp = named("EXT_texture_webp"); webp >= 0)
            return webp;
        if (source.source >= 0)
            return source.source;
        for (const char* name : {"KHR_texture_basisu", "MSFT_texture_dds", "EXT_texture_avif"})
            if (const int image = named(name); image >= 0)
                return image;
        return -1;
    }

    static TextureWrap wrap(int mode) {
        return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? TextureWrap::clamp
               : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? TextureWrap::mirror
                                                               : TextureWrap::repeat;
    }

    const SceneTexture& decode(int index, const std::string& place) {
        if (index < 0)
            throw LostImage{"in a format of an unknown extension"};
        const std::span<const unsigned char> bytes = document_.image_bytes(index); // throws if there is no such image
        SceneTexture& decoded = images_[std::size_t(index)];
        if (decoded.color)
            return decoded;
        const std::string format = image_format(std::as_bytes(bytes));
        if (format == "ktx2" || format == "avif")
            throw LostImage{"in " + (format == "ktx2" ? std::string("KTX2 (BasisU)") : std::string("AVIF")) +
                            ", which can't be decoded"};
        ImageLoading loading;
        loading.meaning = meaning_;
        loading.max_pixels = std::min(kMaximumPixelsOfOne, kMaximumPixels - pixels_);
        const Image image = load_image(std::as_bytes(bytes),
                                       document_.path() + ", image " + std::to_string(index) + " of " + place, loading);
        pixels_ += std::uint64_t(image.width) * std::uint64_t(image.height);
        return decoded = split_alpha(image);
    }

    const GltfDocument& document_;
    std::vector<std::string>& notes_;
    PixelMeaning meaning_;
    std::vector<SceneTexture> images_;
    std::uint64_t pixels_ = 0;
};

} // namespace

std::vector<SceneMaterial> read_gltf_materials(const GltfDocument& document, std::vector<std::string>& notes,
                                               Progress& progress) {
    std::vector<SceneMaterial> materials;
    MaterialReader reader(document, notes);
    for (const tinygltf::Material& source : document.model().materials) {
        progress.throw_if_stopped();
        materials.push_back(reader.read(source, materials.size()));
    }
    materials.emplace_back().name = "default";
    materials.back().is_missing = true;
    return materials;
}

void read_gltf_gloss_textures(const GltfDocument& document, MeshScene& scene, Progress& progress) {
    MaterialReader reader(document, scene.notes, PixelMeaning::data);
    const auto& sources = document.model().materials;
    for (std::size_t i = 0; i < std::min(sources.size(), scene.materials.size()); ++i) {
        progress.throw_if_stopped();
        reader.read_gloss_texture(sources[i], scene.materials[i], i);
    }
}

void read_gltf_normal_textures(const GltfDocument& document, MeshScene& scene, Progress& progress) {
    MaterialReader reader(document, scene.notes, PixelMeaning::data);
    const auto& sources = document.model().materials;
    for (std::size_t i = 0; i < std::min(sources.size(), scene.materials.size()); ++i) {
        progress.throw_if_stopped();
        reader.read_normal_texture(sources[i], scene.materials[i], i);
    }
}

} // namespace kokage
