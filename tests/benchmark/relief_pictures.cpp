// A tiled sphere in light, and the reads of each of its pixels as colours, after [D]'s figure 9.
#include "common/scene/image_file.h"
#include "reflection/compare_images.h"
#include "reflection/relief/relief_openness.h"
#include "tests/benchmark/relief_experiments.h"
#include "tests/benchmark/relief_maps.h"
#include "tests/benchmark/relief_views.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

constexpr std::uint32_t kMostReads = 64; ///< has the scale's brightest colour

Image picture_of_reads(const ReliefView& view, std::span<const ReliefHit> hits) {
    static const Image scale = error_legend(256, 1);
    Image picture(view.width, view.height, 3);
    std::fill(picture.pixels.begin(), picture.pixels.end(), 1.f); // white where no ray is
    for (std::size_t k = 0; k < hits.size(); ++k) {
        const std::uint32_t shade = std::min(hits[k].reads, kMostReads) * 255 / kMostReads;
        const int x = int(view.pixels[k]) % view.width, y = int(view.pixels[k]) / view.width;
        std::copy_n(scale.at(int(shade), 0), 3, picture.at(x, y));
    }
    return picture;
}

/// Under a sun with exact shadows and an even sky with ambient occlusion.
Image lit_picture(const ReliefView& view, const HeightField& field, const ReliefTracer& exact, Progress& progress) {
    const ReliefOpenness openness = horizon_openness(field, {.scale = {glm::vec2(1.f), kBenchReliefDepth}}, progress);
    std::vector<ReliefHit> hits(view.rays.size());
    exact.trace(view.rays, hits);
    const glm::vec3 to_sun = glm::normalize(glm::vec3(-0.75f, 0.5f, 0.45f));
    std::vector<ReliefRay> to_light(hits.size());
    for (std::size_t k = 0; k < hits.size(); ++k) {
        const ReliefFrame& frame = view.frames[k];
        to_light[k] = relief_shadow_ray(
            hits[k], {dot(to_sun, frame.tangent), dot(to_sun, frame.bitangent), dot(to_sun, frame.normal)},
            frame.scale);
    }
    std::vector<std::uint8_t> hidden(hits.size());
    exact.occluded(to_light, hidden);
    Image picture(view.width, view.height, 3);
    std::fill(picture.pixels.begin(), picture.pixels.end(), 1.f);
    const glm::vec3 bark(0.36f, 0.27f, 0.19f), sun(2.2f, 2.0f, 1.7f), sky(0.5f, 0.6f, 0.75f);
    for (std::size_t k = 0; k < hits.size(); ++k) {
        const ReliefFrame& frame = view.frames[k];
        const glm::vec3 local = relief_normal(hits[k].slope, frame.scale);
        const glm::vec3 normal = local.x * frame.tangent + local.y * frame.bitangent + local.z * frame.normal;
        const float lit = dot(frame.normal, to_sun) > 0 && !hidden[k] ? std::max(0.f, dot(normal, to_sun)) : 0.f;
        const glm::vec3 color = bark * (lit * sun + openness.lookup(hits[k].coordinate) * sky);
        float* pixel = picture.at(int(view.pixels[k]) % view.width, int(view.pixels[k]) / view.width);
        for (std::size_t c = 0; c < 3; ++c)
            pixel[c] = std::pow(std::min(color[c], 1.f), 1 / 2.2f); // near enough to sRGB for the eye
    }
    return picture;
}

/// Side by side.
Image row_of(std::span<const Image> pictures) {
    Image row(0, 0, 3);
    for (const Image& one : pictures) {
        row.width += one.width;
        row.height = one.height;
    }
    row.pixels.resize(std::size_t(row.width) * std::size_t(row.height) * 3);
    int left = 0;
    for (const Image& one : pictures) {
        for (int y = 0; y < one.height; ++y)
            std::copy_n(one.at(0, y), std::size_t(one.width) * 3, row.at(left, y));
        left += one.width;
    }
    return row;
}

} // namespace

void draw_reliefs(const ReliefExperimentContext& context) {
    const ReliefView view = sphere_view(384);
    for (const BenchmarkMap& map : context.reliefs.maps()) {
        context.progress.throw_if_stopped();
        ReliefRecord unused;
        const ReliefTracer& exact = context.reliefs.tracer(map, benchmark_methods().front(), unused);
        std::vector<Image> pictures{lit_picture(view, map.field, exact, context.progress)};
        std::string names;
        for (const BenchmarkMethod& method : benchmark_methods()) {
            std::vector<ReliefHit> hits(view.rays.size());
            context.reliefs.tracer(map, method, unused).trace(view.rays, hits);
            pictures.push_back(picture_of_reads(view, hits));
            names += (names.empty() ? "" : ", ") + method.name;
        }
        const std::string file = "relief-" + map.name + "-" + std::to_string(map.field.width) + ".png";
        save_image(context.output_folder / file, row_of(pictures), {.png_encoding = PngEncoding::as_is});
        context.note(file + ": in light; reads a pixel of " + names + "; black 0, pale yellow " +
                     std::to_string(kMostReads) + " and above");
    }
}

} // namespace kokage
