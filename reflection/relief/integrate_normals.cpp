#include "reflection/relief/integrate_normals.h"
#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "reflection/relief/repair_texels.h"
#include "reflection/relief/tile_fourier.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

namespace kokage {
namespace {

constexpr double kCurlShows = 0.5;

/// ∂height/∂u and ∂height/∂v in metres over metres, as arrays.
struct Slopes {
    int width = 0, height = 0;
    std::vector<float> u, v;

    Slopes(int w, int h) : width(w), height(h), u(std::size_t(w) * std::size_t(h)), v(u.size()) {}
};

Slopes slopes_of(const Image& image, NormalMapGreen green, std::size_t& steep) {
    Slopes slopes(image.width, image.height);
    for (std::size_t i = 0; i < slopes.u.size(); ++i) {
        const float* pixel = image.pixels.data() + i * std::size_t(image.channels);
        const glm::dvec3 n = 2. * glm::dvec3(pixel[0], pixel[1], pixel[2]) - 1.;
        const double length = glm::length(n);
        if (!(length >= 0.1 && length <= 10 && n.z > 0)) {
            slopes.u[i] = slopes.v[i] = std::numeric_limits<float>::quiet_NaN();
            continue;
        }
        glm::dvec2 slope(-n.x / n.z, (green == NormalMapGreen::up ? n.y : -n.y) / n.z);
        const double steepness = glm::length(slope);
        if (steepness > kSteepestSlope) {
            slope *= kSteepestSlope / steepness;
            ++steep;
        }
        slopes.u[i] = float(slope.x);
        slopes.v[i] = float(slope.y);
    }
    return slopes;
}

/// Takes the mean off, in double.
void level(std::vector<float>& slopes) {
    double sum = 0;
    for (const float slope : slopes)
        sum += double(slope);
    const float mean = float(sum / double(slopes.size()));
    for (float& slope : slopes)
        slope -= mean;
}

/// Twice as wide and high, as heights are that repeat mirrored at the edges.
Slopes mirrored(const Slopes& slopes) {
    Slopes twice(2 * slopes.width, 2 * slopes.height);
    for (int y = 0; y < twice.height; ++y)
        for (int x = 0; x < twice.width; ++x) {
            const bool turned_x = x >= slopes.width, turned_y = y >= slopes.height;
            const std::size_t from = std::size_t(turned_y ? twice.height - 1 - y : y) * std::size_t(slopes.width) +
                                     std::size_t(turned_x ? twice.width - 1 - x : x);
            const std::size_t to = std::size_t(y) * std::size_t(twice.width) + std::size_t(x);
            twice.u[to] = turned_x ? -slopes.u[from] : slopes.u[from];
            twice.v[to] = turned_y ? -slopes.v[from] : slopes.v[from];
        }
    return twice;
}

/// Frankot, Chellappa 1988, eq 21: of the spectra P and Q of the slopes, Z = -i (kx P + ky Q)/(kx² + ky²). Both slopes
/// are real, so that one transform takes them: S = P + i Q. What is left of the slopes is the curl.
std::vector<float> integrate(const Slopes& slopes, const glm::dvec2& tile_m, double& curl) {
    const int w = slopes.width, h = slopes.height;
    TileWaves waves(w, h);
    for (std::size_t i = 0; i < slopes.u.size(); ++i)
        waves.values[i] = {slopes.u[i], slopes.v[i]};
    transform_forward(waves);
    TileWaves heights(w, h);
    double all = 0, lost = 0;
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            const std::complex<double> s(waves.at(x, y)),
                mirror = std::conj(std::complex<double>(waves.at((w - x) % w, (h - y) % h)));
            const std::complex<double> p = 0.5 * (s + mirror), q = std::complex<double>(0, -0.5) * (s - mirror);
            const glm::dvec2 k = 2 * std::numbers::pi * glm::dvec2(wave_number(x, w), wave_number(y, h)) / tile_m;
            const double square = glm::dot(k, k);
            if (square == 0)
                continue; // heights' mean, and the highest frequencies
            all += std::norm(p) + std::norm(q);
            lost += std::norm(k.x * q - k.y * p) / square;
            heights.at(x, y) = std::complex<float>(std::complex<double>(0, -1) * (k.x * p + k.y * q) / square);
        }
    curl = all > 0 ? std::sqrt(lost / all) : 0;
    transform_backward(heights);
    std::vector<float> result(heights.values.size());
    std::transform(heights.values.begin(), heights.values.end(), result.begin(),
                   [](const auto& z) { return z.real(); });
    return result;
}

template <class... Parts>
std::string joined_text(const Parts&... parts) {
    std::ostringstream stream;
    (stream << ... << parts);
    return stream.str();
}

void repair(Slopes& slopes, const std::string& name, const NormalMapOptions& options, NormalMapReport& report) {
    if (options.strict)
        for (std::size_t i = 0; i < slopes.u.size(); ++i)
            if (!std::isfinite(slopes.u[i]))
                throw InputError(joined_text("'", name, "' has no normal at texel (", i % std::size_t(slopes.width),
                                             ", ", i / std::size_t(slopes.width),
                                             "); mend the image, or do without strictness to have it repaired"));
    report.repaired = repair_texels(slopes.u, slopes.width, slopes.height, options.wrap);
    repair_texels(slopes.v, slopes.width, slopes.height, options.wrap);
    if (2 * report.repaired > slopes.u.size())
        throw InputError(joined_text("'", name, "' is no normal map in the tangent frame: ", report.repaired,
                                     " of its ", slopes.u.size(), " texels do not face outwards; give a bluish one"));
    if (report.repaired > 0)
        report.notes.push_back(joined_text("'", name, "': ", report.repaired,
                                           " texels hold no normal; they were filled from those around them"));
    if (report.steep > 0)
        report.notes.push_back(joined_text("'", name, "': ", report.steep, " slopes are steeper than ", kSteepestSlope,
                                           "; they were reduced"));
}

} // namespace

Relief relief_from_normals(const Image& image, const std::string& name, const NormalMapOptions& options,
                           NormalMapReport& report) {
    ReliefScale scale{options.tile_m, 0};
    check_relief_scale(scale);
    if (image.width < 1 || image.height < 1 || image.channels < 3)
        throw InputError(
            joined_text("'", name, "' has ", image.channels, " channels, a normal map has 3; give a normal map"));
    report = {};
    Slopes slopes = slopes_of(image, options.green, report.steep);
    repair(slopes, name, options, report);
    level(slopes.u);
    level(slopes.v);
    const bool is_mirrored = options.wrap == HeightWrap::clamp;
    const std::vector<float> heights = is_mirrored
                                           ? integrate(mirrored(slopes), 2. * glm::dvec2(options.tile_m), report.curl)
                                           : integrate(slopes, glm::dvec2(options.tile_m), report.curl);
    if (report.curl > kCurlShows)
        report.notes.push_back(joined_text("'", name, "': ", std::round(100 * report.curl),
                                           " % of its slopes belong to no height field; perhaps its green points ",
                                           options.green == NormalMapGreen::up ? "down (DirectX)" : "up (OpenGL)"));
    Relief relief{{image.width, image.height, options.wrap, {}}, scale};
    const std::size_t row = std::size_t(is_mirrored ? 2 * image.width : image.width);
    for (int y = 0; y < image.height; ++y) {
        const auto begin = heights.begin() + std::ptrdiff_t(row * std::size_t(y));
        relief.field.depths.insert(relief.field.depths.end(), begin, begin + image.width);
    }
    const auto [least, most] = std::minmax_element(relief.field.depths.begin(), relief.field.depths.end());
    const float low = *least, high = *most;
    for (float& depth : relief.field.depths)
        depth = high > low ? std::clamp((high - depth) / (high - low), 0.f, 1.f) : 0.f;
    relief.scale.depth_m = high - low;
    if (!std::isfinite(relief.scale.depth_m))
        throw InputError(joined_text("'", name, "': a tile of ", options.tile_m.x, " x ", options.tile_m.y,
                                     " m gives heights that no number holds; give the tile's size in metres"));
    return relief;
}

Relief load_relief_from_normals(const std::filesystem::path& path, const NormalMapOptions& options,
                                NormalMapReport& report) {
    ImageLoading loading;
    loading.meaning = PixelMeaning::data;
    return relief_from_normals(load_image(path, loading), path.string(), options, report);
}

} // namespace kokage
