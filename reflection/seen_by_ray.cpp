#include "reflection/seen_by_ray.h"

#include <algorithm>

namespace kokage {
namespace {

void write(Image& image, int x, int y, const glm::dvec3& sum, std::uint32_t count) {
    for (std::size_t c = 0; c < 3; ++c)
        image.at(x, y)[c] = float(sum[c] / count);
}

} // namespace

void SeenByRay::take(const SurfaceRadiance& light) {
    radiance = light.total();
    direct = light.direct;
    indirect = light.indirect;
    reflection = light.reflection;
}

SeenByRay SeenByRay::surface_at(const SurfacePoint& at, float distance, const PatchScene& patches,
                                const SurfaceRadiance& light) {
    SeenByRay seen;
    seen.take(light);
    seen.albedo = at.optics.reflectance;
    seen.normal = at.normal;
    seen.distance = distance;
    const Patch& patch = patches.patches[at.patch];
    seen.leaf = patch.kind == PatchKind::leaf ? patch.leaf + 1 : 0;
    seen.part = seen_part::of_patch(at.patch, at.front);
    seen.surface = true;
    return seen;
}

SeenByRay SeenByRay::ground_at(const glm::vec3& albedo, float distance, const SurfaceRadiance& light) {
    SeenByRay seen;
    seen.take(light);
    seen.albedo = albedo;
    seen.normal = {0, 1, 0};
    seen.distance = distance;
    seen.part = seen_part::kGround;
    return seen;
}

SeenByRay SeenByRay::surroundings(const glm::vec3& radiance) {
    SeenByRay seen;
    seen.radiance = radiance;
    return seen;
}

Picture empty_picture(const PictureOptions& options) {
    const auto image = [&](int channels) { return Image(options.width, options.height, channels); };
    Picture picture;
    picture.radiance = image(3);
    picture.subject = image(1);
    if (options.layers)
        picture.layers = PictureLayers{image(3), image(3), image(1), image(3), image(3), image(3), image(1)};
    return picture;
}

std::uint32_t most_frequent(std::vector<std::uint32_t>& values) {
    std::sort(values.begin(), values.end());
    std::uint32_t best = 0;
    std::size_t most = 0;
    for (std::size_t begin = 0, end = 0; begin < values.size(); begin = end) {
        while (end < values.size() && values[end] == values[begin])
            ++end;
        if (end - begin > most) {
            most = end - begin;
            best = values[begin];
        }
    }
    return best;
}

void PixelSum::clear() {
    count_ = surfaces_ = 0;
    radiance_ = direct_ = indirect_ = reflection_ = albedo_ = glm::dvec3(0.);
    normal_ = glm::vec3(0.f);
    depth_ = std::numeric_limits<float>::infinity();
    leaves_.clear();
}

void PixelSum::add(const SeenByRay& seen, const glm::vec3& direction) {
    ++count_;
    surfaces_ += seen.surface;
    radiance_ += displayable(seen.radiance);
    if (!layers_)
        return;
    direct_ += displayable(seen.direct);
    indirect_ += displayable(seen.indirect);
    reflection_ += displayable(seen.reflection);
    albedo_ += glm::dvec3(seen.albedo);
    leaves_.push_back(seen.leaf);
    if (const float depth = seen.distance * glm::dot(direction, frame_.forward); depth < depth_) {
        depth_ = depth;
        normal_ = seen.normal;
    }
}

void PixelSum::store(Picture& picture, int x, int y) const {
    write(picture.radiance, x, y, glm::max(radiance_, glm::dvec3(0.)), count_);
    picture.subject.at(x, y)[0] = float(surfaces_) / float(count_);
    if (layers_)
        store_layers(*picture.layers, x, y);
}

void PixelSum::store_layers(PictureLayers& layers, int x, int y) const {
    write(layers.albedo, x, y, albedo_, count_);
    write(layers.direct, x, y, direct_, count_);
    write(layers.indirect, x, y, indirect_, count_);
    write(layers.reflection, x, y, reflection_, count_);
    write(layers.normal, x, y, glm::dvec3(normal_), 1);
    layers.depth.at(x, y)[0] = depth_;
    layers.leaf.at(x, y)[0] = float(most_frequent(leaves_));
}

} // namespace kokage
