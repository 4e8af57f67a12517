#include "tests/benchmark/render_judge.h"
#include "common/services/stopwatch.h"
#include "reflection/camera_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace kokage {
namespace {

constexpr int kSamplesAtOnce = 128; ///< rows of camera hits are kept in memory
constexpr std::uint8_t kSky = 5, kEdge = 4;

class Kinds {
  public:
    explicit Kinds(const AssembledScene& scene, const PictureOptions& picture)
        : scene_(scene), queries_(scene.patches), frame_(camera_frame(scene.camera, picture.width, picture.height)) {}

    std::uint8_t of_pixel(int x, int y) const {
        const std::uint8_t middle = along(float(x) + 0.5f, float(y) + 0.5f);
        for (const float dx : {0.f, 1.f})
            for (const float dy : {0.f, 1.f})
                if (along(float(x) + dx, float(y) + dy) != middle)
                    return kEdge;
        return middle;
    }

  private:
    std::uint8_t along(float x, float y) const {
        RayHit hit;
        if (!queries_.first_hit(frame_.position, frame_.direction(x, y), 0, std::numeric_limits<float>::infinity(),
                                hit))
            return kSky;
        if (hit.ground)
            return 3;
        const std::uint32_t patch = scene_.patches.triangle_patch[hit.triangle];
        if (scene_.patches.patches[patch].kind == PatchKind::leaf)
            return 0;
        return scene_.origins.triangle_part[hit.triangle] < scene_.tree_parts ? 1 : 2;
    }

    const AssembledScene& scene_;
    const RayQueries queries_;
    const CameraFrame frame_;
};

/// Mean of pictures of other seeds each.
Image traced(const AssembledScene& scene, PictureOptions picture, int samples, std::uint64_t seed, Progress& progress) {
    RenderOptions options;
    options.method = RenderMethod::path_traced;
    std::vector<double> sum;
    int pictures = 0;
    for (int done = 0; done < samples; done += kSamplesAtOnce, ++pictures) {
        picture.samples = kSamplesAtOnce;
        picture.seed = seed + std::uint64_t(pictures);
        options.picture = picture;
        const Image part = render_scene(scene, options, progress).picture.radiance;
        sum.resize(part.pixels.size(), 0);
        for (std::size_t i = 0; i < sum.size(); ++i)
            sum[i] += double(part.pixels[i]);
    }
    Image mean(picture.width, picture.height, 3);
    for (std::size_t i = 0; i < sum.size(); ++i)
        mean.pixels[i] = float(sum[i] / pictures);
    return mean;
}

} // namespace

const std::vector<std::string>& pixel_kinds() {
    static const std::vector<std::string> names = {"leaf", "bark", "object", "ground", "edge"};
    return names;
}

RenderTruth find_truth(const AssembledScene& scene, const PictureOptions& picture, int samples, int every_row,
                       Progress& progress) {
    const Stopwatch watch;
    RenderTruth truth;
    PictureOptions rows = picture;
    rows.every_row = every_row;
    const Image one = traced(scene, rows, samples / 2, 1000003, progress),
                two = traced(scene, rows, samples / 2, 2000003, progress);
    truth.cpu_seconds = watch.cpu();
    truth.radiance = one;
    for (std::size_t i = 0; i < one.pixels.size(); ++i)
        truth.radiance.pixels[i] = 0.5f * (one.pixels[i] + two.pixels[i]);
    const Kinds kinds(scene, picture);
    for (int y = 0; y < picture.height; y += every_row)
        for (int x = 0; x < picture.width; ++x)
            if (const std::uint8_t kind = kinds.of_pixel(x, y); kind != kSky) {
                truth.pixels.push_back(std::uint32_t(y * picture.width + x));
                truth.kind.push_back(kind);
            }
    for (const std::uint32_t pixel : truth.pixels)
        for (std::size_t c = 0; c < 3; ++c) {
            truth.mean += double(truth.radiance.pixels[3 * pixel + c]);
            truth.noise += 0.5 * std::abs(double(one.pixels[3 * pixel + c]) - double(two.pixels[3 * pixel + c]));
        }
    truth.noise /= truth.mean > 0 ? truth.mean : 1;
    truth.mean /= 3 * double(std::max<std::size_t>(truth.pixels.size(), 1));
    return truth;
}

void judge(const Image& radiance, const RenderTruth& truth, PictureRecord& record) {
    std::vector<double> errors;
    std::array<double, 5> sums{}, counts{};
    double sum = 0, bias = 0;
    for (std::size_t i = 0; i < truth.pixels.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t at = 3 * std::size_t(truth.pixels[i]) + c;
            const double difference = (double(radiance.pixels[at]) - double(truth.radiance.pixels[at])) / truth.mean;
            errors.push_back(std::abs(difference));
            sum += std::abs(difference);
            bias += difference;
            sums[truth.kind[i]] += std::abs(difference);
            ++counts[truth.kind[i]];
        }
    record.reference_noise = truth.noise;
    if (errors.empty() || !(truth.mean > 0))
        return;
    const auto p95 = errors.begin() + std::ptrdiff_t(0.95 * double(errors.size() - 1));
    std::nth_element(errors.begin(), p95, errors.end());
    record.mean_error = sum / double(errors.size());
    record.p95_error = *p95;
    record.bias = bias / double(errors.size());
    for (std::size_t k = 0; k < counts.size(); ++k)
        if (counts[k] > 0) {
            record.mean_error_of[pixel_kinds()[k]] = sums[k] / counts[k];
            record.share_of[pixel_kinds()[k]] = counts[k] / double(errors.size());
        }
}

} // namespace kokage
