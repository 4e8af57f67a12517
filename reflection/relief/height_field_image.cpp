#include "reflection/relief/height_field_image.h"
#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "reflection/relief/repair_texels.h"
#include "reflection/relief/tiling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace kokage {
namespace {

/// 8-bit JPEG blurs grey by a step or two.
constexpr float kStillGrey = 2.5f / 255;

template <class... Parts>
std::string text(const Parts&... parts) {
    std::ostringstream stream;
    (stream << ... << parts);
    return stream.str();
}

bool is_grey(const Image& image) {
    for (std::size_t i = 0; i < image.pixels.size(); i += std::size_t(image.channels)) {
        const auto [least, most] = std::minmax({image.pixels[i], image.pixels[i + 1], image.pixels[i + 2]});
        if (most - least > kStillGrey * std::max(1.f, std::abs(most)))
            return false;
    }
    return true;
}

/// The image's heights as one channel.
Image grey_of(const Image& image, const std::string& name, const HeightImageOptions& options) {
    const bool colored = image.channels >= 3 && !is_grey(image);
    if (colored && !options.luminance_of_color)
        throw InputError(text("'", name, "' is coloured, a height map is grey: give the height map, give this as a ",
                              "normal map if it is one, or ask for its luminance"));
    Image grey(image.width, image.height, 1);
    for (std::size_t i = 0; i < grey.pixels.size(); ++i) {
        const float* pixel = image.pixels.data() + i * std::size_t(image.channels);
        grey.pixels[i] = colored ? 0.2126f * pixel[0] + 0.7152f * pixel[1] + 0.0722f * pixel[2] : pixel[0];
    }
    return grey;
}

void repair(Image& grey, const std::string& name, const HeightImageOptions& options, HeightImageReport& report) {
    if (options.strict)
        for (std::size_t i = 0; i < grey.pixels.size(); ++i)
            if (!std::isfinite(grey.pixels[i]))
                throw InputError(text("'", name, "' has a height that is ", grey.pixels[i], " at texel (",
                                      i % std::size_t(grey.width), ", ", i / std::size_t(grey.width),
                                      "); mend the image, or do without strictness to have it repaired"));
    report.repaired = repair_texels(grey.pixels, grey.width, grey.height, options.wrap);
    if (report.repaired == grey.pixels.size())
        throw InputError(text("'", name, "' has no finite height at all; export it again"));
    if (report.repaired > 0)
        report.notes.push_back(text("'", name, "': ", report.repaired,
                                    " heights were NaN or infinite; they were filled from those around them"));
}

/// Heights to [0, 1]; returns what 1 was before.
double fit_range(Image& grey, bool stretch) {
    const auto [least, most] = std::minmax_element(grey.pixels.begin(), grey.pixels.end());
    const double low = double(*least), span = double(*most) - low;
    if (!stretch && low >= 0 && low + span <= 1)
        return 1;
    for (float& height : grey.pixels)
        height = span > 0 ? std::clamp(float((double(height) - low) / span), 0.f, 1.f) : 1.f;
    return span;
}

void check_image(const Image& image, const std::string& name) {
    if (image.width < 1 || image.height < 1 || image.channels < 1 || image.channels > 4 ||
        image.pixels.size() != std::size_t(image.width) * std::size_t(image.height) * std::size_t(image.channels))
        throw InputError(text("'", name, "' is not an image of 1 to 4 channels; give a height map"));
}

void measure_seam(const HeightField& field, const std::string& name, HeightImageReport& report) {
    Image depths(field.width, field.height, 1);
    depths.pixels = field.depths;
    report.seam = seam_steps(depths);
    const double worst = std::max(report.seam.x, report.seam.y);
    if (worst >= kSeamShows)
        report.notes.push_back(text("'", name, "' does not tile along ", report.seam.x >= report.seam.y ? "u" : "v",
                                    ": its step over the edge is ", std::round(10 * worst) / 10,
                                    " times that between its texels; have it made to tile, or clamp it"));
}

} // namespace

void check_relief_scale(const ReliefScale& scale) {
    const auto is_length = [](float length) { return std::isfinite(length) && length > 0; };
    if (!is_length(scale.tile_m.x) || !is_length(scale.tile_m.y))
        throw InputError(text("relief: a tile of ", scale.tile_m.x, " x ", scale.tile_m.y,
                              " m has no size; give two lengths above 0"));
    if (!std::isfinite(scale.depth_m) || scale.depth_m < 0)
        throw InputError(text("relief: ", scale.depth_m, " m is no depth; give 0 (flat) or more"));
}

Relief relief_from_image(const Image& image, const ReliefScale& scale, const std::string& name,
                         const HeightImageOptions& options, HeightImageReport& report) {
    check_relief_scale(scale);
    check_image(image, name);
    report = {};
    Image grey = grey_of(image, name, options);
    repair(grey, name, options, report);
    const auto [least, most] = std::minmax_element(grey.pixels.begin(), grey.pixels.end());
    report.least = *least;
    report.most = *most;
    double unit = fit_range(grey, options.stretch);
    if (unit != 1)
        report.notes.push_back(text("'", name, "': heights from ", report.least, " to ", report.most,
                                    " were stretched to 0 ... 1, and the depth with them"));
    if (options.black_is_high)
        for (float& height : grey.pixels)
            height = 1 - height;
    if (options.make_tile) {
        grey = periodic_part(grey);
        unit *= fit_range(grey, false);
    }
    Relief relief{{grey.width, grey.height, options.wrap, std::move(grey.pixels)}, scale};
    for (float& depth : relief.field.depths)
        depth = 1 - depth;
    const double depth_m = unit * double(scale.depth_m);
    if (depth_m > double(std::numeric_limits<float>::max()))
        throw InputError(text("'", name, "': heights from ", report.least, " to ", report.most,
                              " are too far apart; divide them, or give a smaller depth"));
    relief.scale.depth_m = float(depth_m);
    if (options.wrap == HeightWrap::repeat)
        measure_seam(relief.field, name, report);
    return relief;
}

Relief load_relief(const std::filesystem::path& path, const ReliefScale& scale, const HeightImageOptions& options,
                   HeightImageReport& report) {
    ImageLoading loading;
    loading.meaning = PixelMeaning::data;
    return relief_from_image(load_image(path, loading), scale, path.string(), options, report);
}

} // namespace kokage
