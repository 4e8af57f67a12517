#include "tests/benchmark/render_truth.h"
#include "common/services/random.h"
#include "reflection/camera_rays.h"
#include "tests/benchmark/reference.h"
#include "tests/benchmark/render_truth_hash.h"

#include <cmath>
#include <limits>

namespace kokage {
namespace {

constexpr std::uint64_t kSamplesAtOnce = 2048; ///< in each half: how much is lost when the work is stopped
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

/// y width + x of all pixels that are traced.
std::vector<std::uint32_t> traced_pixels(const PictureOptions& picture) {
    std::vector<std::uint32_t> pixels;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            if (is_traced(picture, x, y))
                pixels.push_back(std::uint32_t(y) * std::uint32_t(picture.width) + std::uint32_t(x));
    return pixels;
}

/// Adds the mean of so many paths to a half's sums.
void trace_chunk(const AssembledScene& scene, PictureOptions picture, std::uint64_t samples, std::uint64_t seed,
                 const std::vector<std::uint32_t>& pixels, std::vector<glm::dvec3>& sums, Progress& progress) {
    RenderOptions options;
    options.method = RenderMethod::path_traced;
    options.picture = picture;
    options.picture.samples = int(samples);
    options.picture.seed = seed;
    const Image radiance = render_scene(scene, options, progress).picture.radiance;
    sums.resize(pixels.size(), glm::dvec3(0.0));
    for (std::size_t i = 0; i < pixels.size(); ++i)
        for (glm::length_t c = 0; c < 3; ++c)
            sums[i][c] += double(radiance.pixels[3 * std::size_t(pixels[i]) + std::size_t(c)]);
}

/// Both halves, one behind the other, so that files of leaves' references hold them.
Reference halves_of(const ReferenceSums& sums) {
    Reference halves;
    halves.scene_hash = sums.scene_hash;
    halves.paths_per_side = 2 * sums.paths_per_chunk * sums.chunks;
    for (const std::vector<glm::dvec3>& half : sums.half)
        for (const glm::dvec3& sum : half)
            halves.sides.push_back(glm::vec3(sum / double(sums.chunks)));
    return halves;
}

std::optional<Reference> best_stored(const std::string& file, std::uint64_t hash, const TruthOptions& options) {
    std::optional<Reference> best;
    for (const auto& folder : {options.stored_folder, options.cache_folder}) {
        std::optional<Reference> found = folder.empty() ? std::nullopt : load_reference(folder / file);
        if (found && found->scene_hash == hash && (!best || found->paths_per_side > best->paths_per_side))
            best = std::move(found);
    }
    return best;
}

Reference trace(const AssembledScene& scene, const PictureOptions& picture, const std::string& file, std::uint64_t hash,
                const TruthOptions& options, Progress& progress) {
    std::filesystem::create_directories(options.cache_folder);
    const auto finished = options.cache_folder / file,
               unfinished = std::filesystem::path(finished).replace_extension(".sums");
    const std::uint64_t at_once = std::min(kSamplesAtOnce, std::max<std::uint64_t>(options.samples / 2, 1));
    ReferenceSums sums = load_sums(unfinished, hash, at_once).value_or(ReferenceSums{hash, at_once, 0, {}});
    const std::vector<std::uint32_t> pixels = traced_pixels(picture);
    while (2 * sums.chunks * at_once < options.samples) {
        for (std::uint64_t half = 0; half < 2; ++half)
            trace_chunk(scene, picture, at_once, hash64(0x7472757468ull + 2 * sums.chunks + half), pixels,
                        sums.half[half], progress);
        ++sums.chunks;
        progress.throw_if_stopped();
        save_sums(unfinished, sums);
    }
    save_reference(finished, halves_of(sums));
    return *load_reference(finished); // as it reads back, so that the first run and the next agree
}

PictureTruth judged_part(const AssembledScene& scene, const PictureOptions& picture, const Reference& halves) {
    PictureTruth truth;
    truth.samples = halves.paths_per_side;
    const std::vector<std::uint32_t> pixels = traced_pixels(picture);
    const Kinds kinds(scene, picture);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const int x = int(pixels[i]) % picture.width, y = int(pixels[i]) / picture.width;
        const std::uint8_t kind = kinds.of_pixel(x, y);
        if (kind == kSky)
            continue;
        const glm::vec3 one = halves.sides[i], two = halves.sides[pixels.size() + i];
        truth.pixels.push_back(pixels[i]);
        truth.kind.push_back(kind);
        truth.radiance.push_back(0.5f * (one + two));
        truth.half_difference.push_back(0.5f * (one - two));
        for (glm::length_t c = 0; c < 3; ++c) {
            truth.mean += double(truth.radiance.back()[c]);
            truth.noise += std::abs(double(truth.half_difference.back()[c]));
        }
    }
    truth.noise /= truth.mean > 0 ? truth.mean : 1;
    truth.mean /= 3 * double(std::max<std::size_t>(truth.pixels.size(), 1));
    return truth;
}

} // namespace

const std::vector<std::string>& pixel_kinds() {
    static const std::vector<std::string> names = {"leaf", "bark", "object", "ground", "edge"};
    return names;
}

std::string truth_file_name(const std::string& name, const PictureOptions& picture) {
    return "picture-" + name + "-" + std::to_string(picture.width) + "x" + std::to_string(picture.height) +
           ".reference";
}

PictureTruth find_truth(const AssembledScene& scene, const PictureOptions& picture, const std::string& name,
                        const TruthOptions& options, Progress& progress) {
    const std::uint64_t hash = picture_hash(scene, picture);
    const std::string file = truth_file_name(name, picture);
    std::optional<Reference> halves = best_stored(file, hash, options);
    const bool stored = halves && halves->paths_per_side >= options.samples;
    if (!stored)
        halves = trace(scene, picture, file, hash, options, progress);
    PictureTruth truth = judged_part(scene, picture, *halves);
    truth.is_stored = stored;
    return truth;
}

} // namespace kokage
