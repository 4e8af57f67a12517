#include "viewer/scene/scene_materials.h"
#include "common/scene/image_file.h"

#include <algorithm>

namespace kokage {

std::shared_ptr<const Image> TextureFiles::color(const std::filesystem::path& file) {
    std::shared_ptr<const Image>& image = colors_[file];
    if (!image) {
        image = std::make_shared<Image>(load_image(file, {.meaning = PixelMeaning::color, .channels = 3}));
        bytes_ += image->pixels.size() * sizeof(float);
    }
    return image;
}

std::shared_ptr<const Image> TextureFiles::roughness(const std::filesystem::path& file) {
    std::shared_ptr<const Image>& image = roughnesses_[file];
    if (!image) {
        const Image loaded = load_image(file, {.meaning = PixelMeaning::data});
        const std::size_t channels = std::size_t(loaded.channels), from = channels >= 3 ? 1 : 0;
        auto single = std::make_shared<Image>(loaded.width, loaded.height, 1);
        for (std::size_t i = 0; i < single->pixels.size(); ++i) {
            const float value = loaded.pixels[i * channels + from];
            single->pixels[i] = value > 0 ? std::min(value, 1.f) : 0.f; // NaN becomes 0
        }
        bytes_ += single->pixels.size() * sizeof(float);
        image = std::move(single);
    }
    return image;
}

SceneSurface changed_surface(SceneSurface surface, const MaterialDescription& description, TextureFiles& files) {
    TreeMaterial& material = surface.material;
    Finish& finish = surface.finish;
    if (description.base_color) {
        material.base_color = *description.base_color;
        material.base_color_texture = nullptr;
    }
    if (!description.base_color_texture.empty()) {
        material.base_color_texture = files.color(description.base_color_texture);
        if (!description.base_color)
            material.base_color = glm::vec3(1.f);
    }
    if (description.roughness) {
        material.roughness = float(*description.roughness);
        finish.roughness_texture = nullptr;
    }
    if (!description.roughness_texture.empty()) {
        finish.roughness_texture = files.roughness(description.roughness_texture);
        if (!description.roughness)
            material.roughness = 1;
    }
    if (description.roughness_from_foot_to_top) {
        finish.roughness_from_foot_to_top = description.roughness_from_foot_to_top;
        if (description.roughness_texture.empty())
            finish.roughness_texture = nullptr;
    }
    if (description.metallic)
        finish.metallic = float(*description.metallic);
    if (description.index_of_refraction)
        finish.index_of_refraction = float(*description.index_of_refraction);
    if (description.relief)
        finish.relief = description.relief;
    finish.pointer = description.pointer;
    return surface;
}

Gloss gloss_of(const SceneSurface& surface, const glm::vec3& mean_base_color, float foot, float top) {
    const Finish& finish = surface.finish;
    Gloss gloss;
    // KHR_materials_ior: 0 mirrors all, whatever the angle.
    const float n = finish.index_of_refraction, ratio = n == 0 ? 1 : (n - 1) / (n + 1);
    gloss.tinted_reflectance = finish.metallic * mean_base_color;
    gloss.normal_reflectance = (1 - finish.metallic) * ratio * ratio + gloss.tinted_reflectance;
    gloss.roughness = surface.material.roughness;
    gloss.roughness_texture = finish.roughness_texture;
    if (finish.roughness_from_foot_to_top)
        gloss.roughness_gradient = {foot, top, float(finish.roughness_from_foot_to_top->x),
                                    float(finish.roughness_from_foot_to_top->y)};
    return gloss;
}

glm::vec3 diffuse_share(const SceneSurface& surface, const Gloss& gloss) {
    if (gloss.is_matt())
        return glm::vec3(1 - surface.finish.metallic);
    const float roughness = std::clamp(roughness_bounds(gloss).mean, kLeastRoughness, 1.f);
    return (1 - surface.finish.metallic) *
           (1.f - glm::min(mean_gloss_reflectance(gloss.normal_reflectance, roughness), 1.f));
}

} // namespace kokage
