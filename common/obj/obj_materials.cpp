#include "common/obj/obj_materials.h"

#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "common/services/named_file.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <tiny_obj_loader.h>

namespace kokage {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kMaximumMaterialFile = std::uint64_t(1) << 26;
constexpr std::uint64_t kMaximumTexturePixels = std::uint64_t(1) << 27;
constexpr std::uint64_t kMaximumTexturePixelsOfOne = std::uint64_t(1) << 26;
constexpr std::size_t kMaximumMaterials = std::size_t(1) << 16;

std::string trimmed(const std::string& text) {
    const std::size_t begin = text.find_first_not_of(" \t\r\n"), end = text.find_last_not_of(" \t\r\n");
    return begin == std::string::npos ? "" : text.substr(begin, end - begin + 1);
}

/// A name as another machine's path becomes the file's own name: "C:\\trees\\leaf.png" -> "leaf.png".
std::string own_name(std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    const std::size_t slash = name.find_last_of('/');
    return slash == std::string::npos ? name : name.substr(slash + 1);
}

/// Names of the materials that say Kd: tinyobjloader gives the others a grey of its own.
std::set<std::string> materials_with_color(const std::string& text) {
    std::set<std::string> names;
    std::istringstream lines(text);
    std::string line, name;
    while (std::getline(lines, line)) {
        line = trimmed(line);
        if (line.starts_with("newmtl"))
            name = trimmed(line.substr(6));
        else if (line.starts_with("Kd ") || line.starts_with("Kd\t"))
            names.insert(name);
    }
    return names;
}

bool lies_between_black_and_white(const tinyobj::material_t& source) {
    return std::any_of(source.diffuse, source.diffuse + 3, [](float c) { return c > 0 && c < 1; });
}

/// Nearest texels.
Image resized(const Image& image, int width, int height) {
    Image result(width, height, image.channels);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            std::copy_n(
                image.at(int(std::int64_t(x) * image.width / width), int(std::int64_t(y) * image.height / height)),
                image.channels, result.at(x, y));
    return result;
}

/// The MTL format doesn't say which it is.
float base_color_of(float kd, bool linear) {
    return linear ? kd : linear_from_srgb(kd);
}

float component(float value, float low, float high, float missing) {
    return std::isfinite(value) ? std::clamp(value, low, high) : missing;
}

/// The share of texels that are holes at a cutoff of 0.5.
double share_of_holes(const Image& alpha) {
    const auto holes = std::count_if(alpha.pixels.begin(), alpha.pixels.end(), [](float a) { return a < 0.5f; });
    return alpha.pixels.empty() ? 0 : double(holes) / double(alpha.pixels.size());
}

} // namespace

/// The textures of one MTL file's materials.
class MaterialTextures {
  public:
    MaterialTextures(ObjMaterials& owner, fs::path folder) : owner_(owner), folder_(std::move(folder)) {}

    void read(const tinyobj::material_t& source, SceneMaterial& material, const std::string& place) {
        if (!source.diffuse_texname.empty())
            read_color(source, material, place);
        if (!source.alpha_texname.empty())
            read_mask(source, material, place);
    }

  private:
    void read_color(const tinyobj::material_t& source, SceneMaterial& material, const std::string& place) {
        std::string why;
        const Image* image = find(source.diffuse_texname, PixelMeaning::color, place, why);
        if (!image) {
            material.color_is_lost = true;
            owner_.notes_.push_back(place + ": its colour texture '" + shown_name(source.diffuse_texname) + "' " + why +
                                    ": a plain colour stands in for it");
            return;
        }
        material.base_color_texture = split_alpha(*image);
        if (source.diffuse_texopt.clamp)
            material.base_color_texture->wrap_u = material.base_color_texture->wrap_v = TextureWrap::clamp;
        const auto& alpha = material.base_color_texture->alpha;
        if (alpha && source.alpha_texname.empty() && share_of_holes(*alpha) > 0.01) {
            material.alpha_mode = AlphaMode::mask;
            owner_.notes_.push_back(place + ": the alpha of its colour texture is taken as a mask");
        }
    }

    void read_mask(const tinyobj::material_t& source, SceneMaterial& material, const std::string& place) {
        std::string why;
        const Image* image = find(source.alpha_texname, PixelMeaning::data, place, why);
        if (!image)
            throw InputError(owner_.path_.string() + ": " + place + ": its alpha mask '" +
                             shown_name(source.alpha_texname) + "' " + why +
                             ", and without it every leaf would be a solid card");
        // Alpha if the image has one, else how bright it is.
        Image mask(image->width, image->height, 1);
        const auto channels = std::size_t(image->channels);
        const SceneTexture split = split_alpha(*image);
        for (std::size_t i = 0; i < mask.pixels.size(); ++i)
            mask.pixels[i] = split.alpha ? split.alpha->pixels[i] : image->pixels[i * channels];
        SceneTexture texture = material.base_color_texture.value_or(SceneTexture{});
        if (!texture.color) { // a mask alone: white all over
            auto white = std::make_shared<Image>(mask.width, mask.height, 3);
            std::fill(white->pixels.begin(), white->pixels.end(), 1.f);
            texture.color = white;
        }
        const int width = std::max(mask.width, texture.color->width),
                  height = std::max(mask.height, texture.color->height);
        if (mask.width != width || mask.height != height)
            mask = resized(mask, width, height);
        if (texture.color->width != width || texture.color->height != height)
            texture.color = std::make_shared<Image>(resized(*texture.color, width, height));
        texture.alpha = std::make_shared<Image>(std::move(mask));
        material.base_color_texture = texture;
        material.alpha_mode = AlphaMode::mask;
    }

    /// Null, and `why`, if the image is not there or in a format that can't be decoded. Throws InputError if it is
    /// damaged or too large.
    const Image* find(const std::string& name, PixelMeaning meaning, const std::string& place, std::string& why) {
        fs::path file;
        // Named by another machine's path: looked for by its own name.
        for (const std::string& tried : {name, own_name(name)})
            if (file.empty())
                file = look_for_named_file(folder_, tried, NameReach::relative);
        if (file.empty()) {
            why = "is not there (put it beside the file)";
            return nullptr;
        }
        const std::string key = file.string() + (meaning == PixelMeaning::color ? "" : " as data");
        if (const auto known = owner_.images_.find(key); known != owner_.images_.end())
            return &known->second;
        const std::vector<unsigned char> bytes = read_file_bytes(file, 0xffffffffu);
        const std::string format = image_format(std::as_bytes(std::span(bytes)));
        if (format == "ktx2" || format == "avif") {
            why = format == "ktx2" ? "is in KTX2 (BasisU), which can't be decoded (export it as PNG)"
                                   : "is in AVIF, which can't be decoded (export it as PNG)";
            return nullptr;
        }
        ImageLoading loading;
        loading.meaning = meaning;
        loading.max_pixels = std::min(kMaximumTexturePixelsOfOne, kMaximumTexturePixels - owner_.pixels_);
        const std::string shown = owner_.path_.string() + ": " + place + ": " + file.string();
        // TGA has no magic number: by its name then.
        Image image =
            format.empty() ? load_image(file, loading) : load_image(std::as_bytes(std::span(bytes)), shown, loading);
        owner_.pixels_ += std::uint64_t(image.width) * std::uint64_t(image.height);
        return &owner_.images_.emplace(key, std::move(image)).first->second;
    }

    ObjMaterials& owner_;
    fs::path folder_;
};

bool is_written_by_blender(std::string_view text) {
    while (!text.empty() && text.front() == '#') {
        const std::size_t end = std::min(text.find('\n'), text.size());
        if (text.substr(0, end).find("Blender") != std::string_view::npos)
            return true;
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return false;
}

ObjMaterials::ObjMaterials(fs::path path, std::vector<std::string>& notes) : path_(std::move(path)), notes_(notes) {}

void ObjMaterials::read_library(const std::string& names) {
    const fs::path folder = path_.parent_path();
    // One name that may hold spaces; if there is no such file, several.
    std::vector<std::string> tried{trimmed(names)};
    std::istringstream words(names);
    for (std::string word; words >> word;)
        if (word != tried.front())
            tried.push_back(word);
    bool found = false;
    for (std::size_t i = 0; i < tried.size(); ++i) {
        fs::path file;
        for (const std::string& name : {tried[i], own_name(tried[i])})
            if (file.empty())
                file = look_for_named_file(folder, name, NameReach::own_folder);
        if (file.empty())
            continue;
        read_file(file);
        found = true;
        if (i == 0)
            break;
    }
    if (!found)
        notes_.push_back("its material file '" + shown_name(trimmed(names)) +
                         "' is not there: plain colours stand in for its materials, and cards of leaves are solid; put "
                         "it beside the file");
}

void ObjMaterials::read_file(const fs::path& file) {
    const std::vector<unsigned char> bytes = read_file_bytes(file, kMaximumMaterialFile);
    const std::string text(bytes.begin(), bytes.end());
    std::istringstream stream(text);
    std::map<std::string, int> indices;
    std::vector<tinyobj::material_t> sources;
    std::string warning, error;
    tinyobj::LoadMtl(&indices, &sources, &stream, &warning, &error);
    if (sources.size() + materials_.size() > kMaximumMaterials)
        throw InputError(file.string() + ": more than the limit of " + std::to_string(kMaximumMaterials) +
                         " materials");
    const std::set<std::string> colored = materials_with_color(text);
    const bool linear = kd_is_linear_ || is_written_by_blender(text);
    bool reading_matters = false;
    MaterialTextures textures(*this, file.parent_path());
    for (const tinyobj::material_t& source : sources) {
        const std::string name = trimmed(source.name);
        if (by_name_.contains(name))
            continue;
        const std::string place = "material '" + shown_name(name) + "'";
        SceneMaterial material;
        material.name = name;
        material.double_sided = true;
        const bool has_color = colored.contains(name);
        for (std::size_t c = 0; c < 3; ++c)
            material.base_color[c] = has_color ? base_color_of(component(source.diffuse[c], 0, 1, 0.5f), linear) : 1.f;
        reading_matters = reading_matters || (has_color && lies_between_black_and_white(source));
        material.base_color.a = component(source.dissolve, 0, 1, 1);
        if (material.base_color.a < 1)
            material.alpha_mode = AlphaMode::blend;
        material.roughness = source.roughness > 0 ? component(source.roughness, 0, 1, 1) : 1.f;
        material.color_is_lost = !has_color && source.diffuse_texname.empty();
        textures.read(source, material, place);
        TextureOptions options;
        const auto& texture = source.diffuse_texname.empty() ? source.alpha_texopt : source.diffuse_texopt;
        for (std::size_t c = 0; c < 2; ++c) {
            options.offset[c] = component(texture.origin_offset[c], -1e6f, 1e6f, 0);
            options.scale[c] = component(texture.scale[c], -1e6f, 1e6f, 1);
        }
        by_name_[name] = int(materials_.size());
        materials_.push_back(std::move(material));
        options_.push_back(options);
    }
    if (reading_matters)
        notes_.push_back(linear ? "its colours (Kd) are read as linear, as Blender writes them"
                                : "its colours (Kd) are read as sRGB, as most programs but Blender write them");
}

int ObjMaterials::index_of(const std::string& name) {
    const auto [found, is_new] = by_name_.try_emplace(name, int(materials_.size()));
    if (is_new) {
        if (materials_.size() >= kMaximumMaterials)
            throw InputError(path_.string() + ": more than the limit of " + std::to_string(kMaximumMaterials) +
                             " materials");
        SceneMaterial& material = materials_.emplace_back();
        material.name = name.empty() ? "default" : name;
        material.is_missing = name.empty();
        material.double_sided = true;
        material.color_is_lost = !vertices_have_colors_;
        options_.emplace_back();
        if (!name.empty() && notes_.size() < 100)
            notes_.push_back(
                "material '" + shown_name(name) + "' is described nowhere: " +
                (vertices_have_colors_ ? "the vertices' colours are taken" : "a plain colour stands in for it"));
    }
    return found->second;
}

} // namespace kokage
