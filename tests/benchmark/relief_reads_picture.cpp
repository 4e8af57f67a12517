// Reads per pixel as colours, after [D]'s figure 9.
#include "common/scene/image_file.h"
#include "reflection/compare_images.h"
#include "tests/benchmark/relief_experiments.h"
#include "tests/benchmark/relief_views.h"

#include <algorithm>

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

void draw_relief_reads(const ReliefExperimentContext& context) {
    const ReliefView view = sphere_view(384);
    for (const BenchmarkMap& map : context.reliefs.maps()) {
        context.progress.throw_if_stopped();
        std::vector<Image> pictures;
        std::string names;
        for (const BenchmarkMethod& method : benchmark_methods()) {
            std::vector<ReliefHit> hits(view.rays.size());
            ReliefRecord unused;
            context.reliefs.tracer(map, method, unused).trace(view.rays, hits);
            pictures.push_back(picture_of_reads(view, hits));
            names += (names.empty() ? "" : ", ") + method.name;
        }
        const std::string file = "relief-reads-" + map.name + "-" + std::to_string(map.field.width) + ".png";
        save_image(context.output_folder / file, row_of(pictures), {.png_encoding = PngEncoding::as_is});
        context.note(file + ": reads a pixel of " + names + "; black 0, pale yellow " + std::to_string(kMostReads) +
                     " and above");
    }
}

} // namespace kokage
