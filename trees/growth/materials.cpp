#include "trees/growth/materials.h"

#include "trees/growth/bark_image.h"
#include "trees/growth/leaf_image.h"
#include "trees/growth/leaf_optics.h"
#include "trees/growth/leaf_shape.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <string>

namespace kokage {
namespace {

/// Bark images of the same kind and age are the same: they are drawn once.
std::shared_ptr<const BarkImage> drawn_bark(BarkKind kind, float age) {
    static std::mutex mutex;
    static std::map<std::pair<BarkKind, float>, std::shared_ptr<const BarkImage>> drawn;
    const std::lock_guard lock(mutex);
    std::shared_ptr<const BarkImage>& image = drawn[{kind, age}];
    if (!image)
        image = std::make_shared<BarkImage>(bark_image(kind, age));
    return image;
}

std::string bark_name(BarkKind kind, float age) {
    if (!turns_with_age(kind) || age == 0)
        return " bark";
    if (age == 1)
        return " old bark";
    return " bark, " + std::to_string(std::lround(100 * age)) + " % old";
}

} // namespace

TreeMaterial leaf_material(const GrowthParameters& p) {
    TreeMaterial material;
    material.name = p.species + (is_in_blossom(p) ? " blossom" : " leaf");
    // rho = (1 - f) base, tau = f transmission colour; f is the same for all channels, the colours make up the rest.
    const LeafOptics optics = is_in_blossom(p)              ? leaf_optics(LeafKind::cherry, Season::blossom)
                              : p.season == Season::blossom ? leaf_optics(p.leaf_color, Season::spring)
                                                            : leaf_optics(p.leaf_color, p.season);
    const float through = luminance(optics.transmittance),
                f = std::clamp(through / (through + luminance(optics.reflectance)), 0.1f, 0.5f);
    material.diffuse_transmission = f;
    material.diffuse_transmission_color = optics.transmittance / f;
    material.base_color = optics.reflectance / (1 - f);
    material.roughness = 0.6f;
    material.wrap_u = material.wrap_v = TextureWrap::clamp;
    if (p.leaf_form == LeafForm::alpha) {
        material.alpha_texture = leaf_mask(p);
        material.alpha_cutoff = mask_cutoff;
    }
    if (p.textures) {
        material.base_color_texture = leaf_color(p, material.base_color);
        material.base_color = glm::vec3(1.f);
    }
    return material;
}

TreeMaterial bark_material(const GrowthParameters& p, const BarkZone& zone) {
    TreeMaterial material;
    material.double_sided = false;
    if (zone.is_twig) {
        material.name = p.species + " twig";
        material.base_color = young_twig_color(p.bark);
        material.roughness = 0.8f;
        return material;
    }
    material.name = p.species + bark_name(p.bark, zone.age);
    material.roughness = bark_roughness(p.bark);
    if (p.textures) {
        const std::shared_ptr<const BarkImage> bark = drawn_bark(p.bark, zone.age);
        material.base_color_texture = std::shared_ptr<const Image>(bark, &bark->color);
        material.height_texture = std::shared_ptr<const Image>(bark, &bark->height);
        material.height_depth_m = bark->depth_m;
        material.height_tile_m = float(p.bark_tile);
    } else {
        material.base_color = mean_bark_color(p.bark, zone.age);
    }
    return material;
}

} // namespace kokage
